"""The report as files: an overview, and a page an experiment with its data beside it.

The same results give the same bytes.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from harness.errors import InputError
from harness.report import palette
from harness.report.backends import BackendsPage
from harness.report.comparison import Comparison
from harness.report.figures import Figure
from harness.report.pages import (
    ExperimentPage,
    csv,
    folder_of,
    machine_rows,
    machine_text,
    published_section,
    verdict_groups,
)
from harness.report.published import Row
from harness.report.quantity import plural
from harness.report.sweeps import facts as sweep_facts
from harness.report.sweeps import newest_comparison, points_table
from harness.report.sweeps import summary as comparison_summary
from harness.store.records import ExperimentRecord, SweepRecord, VerdictRow
from harness.store.tables import comparisons, conditions, controls, experiments, machines, runs

SWEEPS = "sweeps.html"
BACKENDS = "backends.html"


@dataclass(frozen=True)
class Link:
    """One entry of the navigation; `here` is the page it stands on."""

    title: str
    href: str
    here: bool = False


@dataclass(frozen=True, eq=False)
class Listed:
    """An experiment as the overview lists it."""

    page: ExperimentPage
    href: str
    figure: Figure | None

    @property
    def axis(self) -> str:
        """What the small figure shows: of several panels, the first."""
        panel = next(iter(self.page.arrangement.panels), "")
        return ", ".join(part for part in (self.figure.title if self.figure else "", panel) if part)

    @property
    def badges(self) -> list[tuple[str, str]]:
        """(text, class) of what to know at a glance."""
        found = [(self.page.stability, self.page.stability)] if self.page.stability else []
        if self.page.failed:
            found.append((f"{self.page.failed} failed", "failed"))
        for verdict in ("holds", "fails", "undecided"):
            count = sum(row.verdict == verdict for row in self.page.record.claims)
            if count:
                word = {"holds": "hold", "fails": "fail"}.get(verdict, verdict) if count > 1 else verdict
                found.append((f"{plural(count, 'claim')} {word}", verdict))
        if self.page.findings.warnings:
            found.append((plural(len(self.page.findings.warnings), "warning"), "noisy"))
        return found

    @property
    def size(self) -> str:
        """How much was measured."""
        return f"{plural(len(self.page.record.points), 'point')}, {plural(len(self.page.runs), 'run')}"


def write_report(database: str | Path, out: str | Path) -> Path:
    """Write the pages of a results file, and return the overview's path.

    Files that the report does not make are left alone.

    Parameters
    ----------
    database : the results file; it is only read
    out : folder of the pages, made where it is missing

    Raises
    ------
    InputError
        The results file cannot be read, or the folder cannot be written to.
    """
    out = Path(out)
    contents = list(render(database))  # all of it or, where something is wrong, nothing
    try:
        for name, text in contents:
            path = out / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise InputError(
            f"{error.filename or out}: cannot be written: {error.strerror}; give another folder with --out"
        ) from error
    return out / "index.html"


def render(database: str | Path) -> Iterator[tuple[str, str]]:
    """Every file of the report: (path below the report, text)."""
    table, records = runs(database), experiments(database)
    taken: set[str] = set()
    pages = [
        ExperimentPage(
            record,
            table[table["experiment"] == record.name],
            folder_of(record.name, taken),
            controls(database, [record.name]),
            conditions(database, record.name),
        )
        for record in records
    ]
    environment = _environment()
    rows = {page.record.name: page.published for page in pages}
    claims, compared = any(record.claims for record in records), newest_comparison(database)
    backends = BackendsPage(comparisons(database), table)
    others = [Link("Backends", BACKENDS)] if backends.records else []
    others += [Link("Sweeps compared", SWEEPS)] if compared is not None else []
    for page in pages:
        elsewhere = [row for name, found in rows.items() if name != page.record.name for row in found]
        yield from _experiment(environment, page, elsewhere, claims, others)
    yield "index.html", _index(environment, pages, records, others, machines(database))
    if compared is not None:
        yield SWEEPS, _compared(environment, compared, claims, others, records)
    if backends.records:
        yield BACKENDS, _backends(environment, backends, claims, others, records)
        yield from backends.files()
    yield "runs.csv", csv(table)


def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("harness.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=False
    )
    templates = files("harness.report") / "templates"
    environment.globals |= {
        "style": Markup((templates / "style.css").read_text(encoding="utf-8")),
        "script": Markup((templates / "sort.js").read_text(encoding="utf-8")),
        "light": Markup(palette.variables(dark=False)),
        "dark": Markup(palette.variables(dark=True)),
        "outlines": [palette.OUTLINES[marker] for marker in palette.MARKERS],
        "verdict_groups": verdict_groups,
    }
    return environment


def _navigation(up: str, claims: bool, others: Sequence[Link], here: Link | None = None) -> list[Link]:
    """The way through the site; `others` are the pages beside the overview that have something to show."""
    overview = Link("Overview", f"{up}index.html", here is None)
    titles = ("Experiments", "Claims", "Data") if claims else ("Experiments", "Data")
    places = [Link(title, f"{up}index.html#{title.lower()}") for title in titles]
    further = [replace(link, href=f"{up}{link.href}") for link in others if here is None or here.href != link.href]
    return [overview, *places, *further, *([here] if here else [])]


def _experiment(
    environment: Environment, page: ExperimentPage, elsewhere: Sequence[Row], claims: bool, others: Sequence[Link]
) -> Iterator[tuple[str, str]]:
    published = published_section(page, elsewhere)
    drawn = [*page.figures, page.exponent_figure, published.figure if published else None]
    figures = [figure for figure in drawn if figure]
    downloads = [
        ("runs.csv", "runs, CSV"),
        ("specification.yaml", "specification"),
        ("environment.json", "environment, JSON"),
    ]
    downloads += [(figure.file, f"{figure.title}, SVG") for figure in figures]
    verdicts = [("claims", "Claims", page.record.claims), ("expectations", "Expectations", page.record.expectations)]
    verdicts = [entry for entry in verdicts if entry[2]]
    here = Link(page.record.name, "", here=True)
    text = environment.get_template("experiment.html.j2").render(
        title=f"{page.record.title} · harness",
        navigation=_navigation("../" * len(page.folder.parts), claims, others, here),
        page=page,
        published=published,
        verdicts=verdicts,
        contents=_contents(page, published is not None),
        environment=[*_facts(page.record.sweep), *page.conditions],
        downloads=downloads,
        footer=_footer([page.record]),
    )
    yield f"{page.folder}/index.html", text
    yield f"{page.folder}/runs.csv", page.csv
    yield f"{page.folder}/specification.yaml", page.record.source
    yield f"{page.folder}/environment.json", json.dumps(page.environment, indent=2, ensure_ascii=False) + "\n"
    for figure in figures:
        yield f"{page.folder}/{figure.file}", figure.document


def _contents(page: ExperimentPage, published: bool) -> list[tuple[str, str]]:
    entries = (
        ("findings", "Findings", True),
        ("figures", "Figures", bool(page.figures)),
        ("exponents", "Exponents", bool(page.exponents)),
        ("results", "Results", True),
        ("failures", "Failures", page.failures is not None),
        ("claims", "Claims", bool(page.record.claims)),
        ("expectations", "Expectations", bool(page.record.expectations)),
        ("published", "Published", published),
        ("plan", "Plan", bool(page.stages)),
        ("reading", "How to read", True),
        ("reproduce", "Reproduce", True),
    )
    return [(identity, title) for identity, title, there in entries if there]


def _index(
    environment: Environment,
    pages: Sequence[ExperimentPage],
    records: Sequence[ExperimentRecord],
    others: Sequence[Link],
    machines: Mapping[str, Mapping[str, Any]],
) -> str:
    listed = []
    for place, page in enumerate(pages):
        # ids are unique on a page, and the overview shows figures of many
        figure = replace(page.figures[0], name=f"card{place}") if page.figures else None
        listed.append(Listed(page, f"{page.folder}/index.html", figure))
    claims: list[tuple[Listed, VerdictRow]] = [(entry, row) for entry in listed for row in entry.page.record.claims]
    used = {record.sweep.fingerprint for record in records}.union(*(set(page.runs["machine"]) for page in pages))
    total, failed = sum(len(page.runs) for page in pages), sum(page.failed for page in pages)
    totals = f"{plural(len(pages), 'experiment')}, {plural(total, 'run')}, {failed or 'none'} failed."
    verdicts = Counter(row.verdict for _, row in claims)
    if claims:
        ways = (("holds", "hold"), ("fails", "do not"), ("undecided", "undecided"))
        said = ", ".join(f"{verdicts[verdict]} {word}" for verdict, word in ways if verdicts[verdict])
        totals += f" Of {plural(len(claims), 'claim')}, {said}."
    return environment.get_template("index.html.j2").render(
        title="Overview · harness",
        navigation=_navigation("", bool(claims), others) if pages else [Link("Overview", "", here=True)],
        pages=listed,
        failures=[(entry, sentence) for entry in listed for sentence in entry.page.findings.failures],
        claims=claims,
        machines=[(machine_text(facts), machine_rows(facts)) for name, facts in machines.items() if name in used],
        totals=totals,
        footer=_footer(records),
    )


def _backends(
    environment: Environment,
    page: BackendsPage,
    claims: bool,
    others: Sequence[Link],
    records: Sequence[ExperimentRecord],
) -> str:
    entries = (
        ("matrix", "Matrix", True),
        ("gaps", "Gaps", page.gaps is not None),
        ("cases", "Proven wrong", bool(page.cases)),
        ("approximations", "Approximations", page.approximations is not None),
        ("flights", "In flight", page.flights is not None),
        ("speed", "Speed", bool(page.speeds)),
        ("reading", "How to read", True),
    )
    return environment.get_template("backends.html.j2").render(
        title="Backends · harness",
        navigation=_navigation("", claims, others, Link("Backends", BACKENDS, here=True)),
        contents=[(identity, title) for identity, title, there in entries if there],
        page=page,
        footer=_footer(records),
    )


def _compared(
    environment: Environment,
    found: Comparison,
    claims: bool,
    others: Sequence[Link],
    records: Sequence[ExperimentRecord],
) -> str:
    return environment.get_template("sweeps.html.j2").render(
        title="Sweeps compared · harness",
        navigation=_navigation("", claims, others, Link("Sweeps compared", SWEEPS, here=True)),
        sentences=comparison_summary(found),
        verdicts=found.verdicts,
        points=points_table(found),
        before=sweep_facts(found.before),
        after=sweep_facts(found.after),
        footer=_footer(records),
    )


def _facts(sweep: SweepRecord) -> list[tuple[str, str]]:
    packages = ", ".join(f"{name} {version}" for name, version in sweep.packages.items())
    return [
        ("swept", f"{sweep.started} – {sweep.finished or 'not finished'}"),
        ("command", sweep.command),
        ("harness", f"{sweep.version}, commit {sweep.commit or 'unknown'}"),
        *machine_rows(sweep.machine),
        ("packages", packages),
    ]


def _footer(records: Sequence[ExperimentRecord]) -> Markup:
    """Where the pages come from: all of it from the results, so that the same results give the same page."""
    if not records:
        return Markup("Made by <code>harness report</code>")
    newest = max((record.sweep for record in records), key=lambda sweep: sweep.id)
    commit = Markup(" · commit <code>{}</code>").format(newest.commit[:12]) if newest.commit else Markup("")
    return Markup("Made by <code>harness report</code> · swept {} with harness {}{}").format(
        newest.started, newest.version, commit
    )
