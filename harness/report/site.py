"""The report as files: an overview, and a page an experiment with its data beside it.

The same results give the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from harness.errors import InputError
from harness.report import palette
from harness.report.accuracy import AccuracySection, sections
from harness.report.backends import BackendsPage
from harness.report.comparison import Comparison
from harness.report.missing import is_judged, missing_runs
from harness.report.overview import Overview
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
from harness.report.replay import Replay, replay_of
from harness.report.stability import MEANINGS, SIGNS, Matrix, is_case, matrix
from harness.report.summary import summary
from harness.report.sweeps import facts as sweep_facts
from harness.report.sweeps import newest_comparison, points_table
from harness.report.sweeps import summary as comparison_summary
from harness.store.records import ExperimentRecord, SweepRecord
from harness.store.tables import comparisons, conditions, controls, experiments, machines, runs

SWEEPS, STABILITY, ACCURACY = "sweeps.html", "stability.html", "accuracy.html"
BACKENDS = "backends.html"
TITLES = {ACCURACY: "Error against run time", BACKENDS: "Backends", STABILITY: "Stability", SWEEPS: "Sweeps compared"}


@dataclass(frozen=True)
class Link:
    """One entry of the navigation; `here` is the page it stands on."""

    title: str
    href: str
    here: bool = False


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
    environment.globals["missing"] = missing_runs(records, table)
    rows = {page.record.name: page.published for page in pages}
    # claims of the cases of stability stand in their matrix, where they say how far a method falls short
    claims = any(is_judged(row) for page in pages if not is_case(page) for row in page.record.claims)
    compared = newest_comparison(database)
    accuracy, stability = sections(pages), matrix(pages)
    backends = BackendsPage(comparisons(database), table)
    present = (
        (ACCURACY, bool(accuracy)),
        (BACKENDS, bool(backends.records)),
        (STABILITY, stability is not None),
        (SWEEPS, compared is not None),
    )
    further = [file for file, there in present if there]
    replays: dict[str, str] = {}  # file by the name of its experiment
    for page in pages:
        elsewhere = [row for name, found in rows.items() if name != page.record.name for row in found]
        replay = replay_of(database, page.record)
        if replay is not None:
            replays[page.record.name] = f"{page.folder}/{replay.file}"
        yield from _experiment(environment, page, elsewhere, claims, further, replay)
    overview = Overview(pages, accuracy, stability)
    yield "index.html", _index(environment, overview, further, machines(database), records)
    if accuracy:
        yield from _accuracy(environment, accuracy, claims, further, records)
    if backends.records:
        yield BACKENDS, _backends(environment, backends, claims, further, records)
        yield from backends.files()
    if stability is not None:
        yield STABILITY, _stability(environment, stability, pages, replays, claims, further)
    if compared is not None:
        yield SWEEPS, _compared(environment, compared, claims, further, records)
    decisions = [said for section in accuracy for said in section.decisions]
    yield "findings.md", summary(pages, decisions, stability.sentences if stability else ())
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


def _navigation(up: str, claims: bool, further: Sequence[str], here: Link | None = None) -> list[Link]:
    """The way through the site; `further` are the files of the pages that it has beside those of experiments."""
    overview = Link("Overview", f"{up}index.html", here is None)
    titles = ("Experiments", "Claims", "Data") if claims else ("Experiments", "Data")
    places = [Link(title, f"{up}index.html#{title.lower()}") for title in titles]
    others = [here if here and here.href == file else Link(TITLES[file], f"{up}{file}") for file in further]
    return [overview, *places, *others, *([here] if here and here not in others else [])]


def _experiment(
    environment: Environment,
    page: ExperimentPage,
    elsewhere: Sequence[Row],
    claims: bool,
    further: Sequence[str],
    replay: Replay | None,
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
        navigation=_navigation("../" * len(page.folder.parts), claims, further, here),
        page=page,
        published=published,
        verdicts=verdicts,
        replay=replay,
        contents=_contents(page, published is not None, replay is not None),
        environment=[*_facts(page.record.sweep), *page.conditions],
        downloads=downloads,
        footer=_footer([page.record]),
        missing=missing_runs([page.record], page.runs),
    )
    yield f"{page.folder}/index.html", text
    if replay is not None:
        yield f"{page.folder}/{replay.file}", replay.page
    yield f"{page.folder}/runs.csv", page.csv
    yield f"{page.folder}/specification.yaml", page.record.source
    yield f"{page.folder}/environment.json", json.dumps(page.environment, indent=2, ensure_ascii=False) + "\n"
    for figure in figures:
        yield f"{page.folder}/{figure.file}", figure.document


def _contents(page: ExperimentPage, published: bool, replay: bool) -> list[tuple[str, str]]:
    entries = (
        ("findings", "Findings", True),
        ("figures", "Figures", bool(page.figures)),
        ("exponents", "Exponents", bool(page.exponents)),
        ("results", "Results", True),
        ("failures", "Failures", page.failures is not None),
        ("claims", "Claims", bool(page.record.claims)),
        ("expectations", "Expectations", bool(page.record.expectations)),
        ("published", "Published", published),
        ("replay", "Replay", replay),
        ("plan", "Plan", bool(page.stages)),
        ("reading", "How to read", True),
        ("reproduce", "Reproduce", True),
    )
    return [(identity, title) for identity, title, there in entries if there]


def _index(
    environment: Environment,
    found: Overview,
    further: Sequence[str],
    machines: Mapping[str, Mapping[str, Any]],
    records: Sequence[ExperimentRecord],
) -> str:
    used = {record.sweep.fingerprint for record in records}.union(*(set(page.runs["machine"]) for page in found.pages))
    return environment.get_template("index.html.j2").render(
        title="Overview · harness",
        navigation=_navigation("", bool(found.claims), further) if found.pages else [Link("Overview", "", here=True)],
        overview=found,
        machines=[(machine_text(facts), machine_rows(facts)) for name, facts in machines.items() if name in used],
        decisions=[
            (f"{ACCURACY}#{section.identity}", said) for section in found.accuracy for said in section.decisions
        ],
        footer=_footer(records),
    )


def _stability(
    environment: Environment,
    found: Matrix,
    pages: Sequence[ExperimentPage],
    replays: Mapping[str, str],
    claims: bool,
    further: Sequence[str],
) -> str:
    cases = [page for page in pages if is_case(page)]
    return environment.get_template("stability.html.j2").render(
        title="Stability · harness",
        navigation=_navigation("", claims, further, Link(TITLES[STABILITY], STABILITY, here=True)),
        matrix=found,
        signs=SIGNS,
        meanings=MEANINGS,
        cases=cases,
        replays=replays,
        footer=_footer([page.record for page in cases]),
    )


def _accuracy(
    environment: Environment,
    found: Sequence[AccuracySection],
    claims: bool,
    further: Sequence[str],
    records: Sequence[ExperimentRecord],
) -> Iterator[tuple[str, str]]:
    yield (
        ACCURACY,
        environment.get_template("accuracy.html.j2").render(
            title=f"{TITLES[ACCURACY]} · harness",
            navigation=_navigation("", claims, further, Link(TITLES[ACCURACY], ACCURACY, here=True)),
            sections=found,
            decisions=[said for section in found for said in section.decisions],
            footer=_footer(records),
        ),
    )
    for section in found:
        for figure in section.figures:
            yield figure.file, figure.document


def _backends(
    environment: Environment,
    page: BackendsPage,
    claims: bool,
    further: Sequence[str],
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
        navigation=_navigation("", claims, further, Link(TITLES[BACKENDS], BACKENDS, here=True)),
        contents=[(identity, title) for identity, title, there in entries if there],
        page=page,
        footer=_footer(records),
    )


def _compared(
    environment: Environment,
    found: Comparison,
    claims: bool,
    further: Sequence[str],
    records: Sequence[ExperimentRecord],
) -> str:
    return environment.get_template("sweeps.html.j2").render(
        title=f"{TITLES[SWEEPS]} · harness",
        navigation=_navigation("", claims, further, Link(TITLES[SWEEPS], SWEEPS, here=True)),
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
