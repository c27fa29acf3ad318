"""Who tells rightly when spinning bodies begin to touch: engines held against cases with proven times."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.report.figure import figures_of
from harness.report.page import Content, Page
from harness.report.quantity import number, plural
from harness.report.results import Results
from harness.report.table import Column, Entry, Table, counted, counted_bad, plain, words
from harness.report.truth import ALL, TruthPart

_KINDS = ("missed", "late", "early", "false", "failed")


def _content(results: Results) -> Content | None:
    asked = results.truth
    if not asked.records:
        return None
    figures = figures_of("truth", asked)
    parts = [
        (part, figure, _table(part), _notes(part)) for part, figure in zip(asked.parts, figures["matrix"], strict=True)
    ]
    values = {
        "summary": [sentence for part in asked.parts for sentence in _summary(part)],
        "parts": parts,
        "commands": list(dict.fromkeys(record.command for record in asked.records)),
    }
    return Content("truth.html.j2", values, results.records, figures["matrix"])


def _summary(part: TruthPart) -> list[str]:
    """Of everyone who was asked, a sentence."""
    counted = {part.heading(engine): part.count(engine, ALL) for engine in part.engines}
    return [_sentence(engine, found) for engine, found in counted.items() if found is not None]


def _sentence(engine: str, found: Mapping[str, Any]) -> str:
    if found["right"] == found["asked"]:
        return f"{engine} is right about all of {plural(found['asked'], 'case')}."
    wrong = [f"{number(found[kind])} {kind}" for kind in _KINDS if found[kind]]
    latest = f"; the latest answer comes {number(found['latest'])} s after the touch" if found["late"] else ""
    said = f"{engine} is right about {number(found['right'])} of {plural(found['asked'], 'case')}"
    return f"{said}: {', '.join(wrong)}{latest}."


def _table(part: TruthPart) -> Table:
    rows = tuple(
        _row(part.heading(engine), family, found)
        for engine in part.engines
        for family in [*part.families, ALL]
        if (found := part.count(engine, family)) is not None
    )
    columns = (
        Column("Engine", numeric=False), Column("Family", numeric=False), Column("asked"), Column("right"),
        *(Column(kind) for kind in _KINDS), Column("latest", "s"), Column("earliest", "s"), Column("a query", "ms CPU"),
    )  # fmt: skip
    note = (
        "“Latest” and “earliest” are the most that an answer was out of the proven bounds. A query is one pair over "
        "its whole window, the median; of an engine that is stepped it is all frames up to the answer."
    )
    return Table(part.name, note, columns, rows)


def _row(engine: str, family: str, found: Mapping[str, Any]) -> tuple[Entry, ...]:
    seconds = found["seconds_a_query"]
    return (
        words(engine),
        words(family),
        counted(found["asked"]),
        counted(found["right"]),
        *(counted_bad(found[kind]) for kind in _KINDS),
        *(_seconds(found[name]) for name in ("latest", "earliest")),
        Entry(number(1e3 * seconds) if seconds else "", sort=plain(seconds or 0.0)),
    )


def _seconds(time: float) -> Entry:
    return Entry(number(time) if time else "", sort=plain(time))


def _notes(part: TruthPart) -> list[str]:
    """Who could not be asked, or not about everything, and what failed."""
    found = []
    for engine, asked in part.asked.items():
        label = part.heading(engine)
        if asked["problem"]:
            found.append(f"{label} was not asked: {asked['problem']}")
            continue
        if asked["every"] > 1:
            found.append(f"{label} was asked about one case in {asked['every']} of each family.")
        if without := asked["families"][ALL]["without_shape"]:
            found.append(f"{label} has not the shapes of {plural(without, 'case')}, which it was not asked about.")
        found += [f"{label} failed at {plural(cases, 'case')}: {why}" for why, cases in asked["failures"].items()]
    return found


PAGE = Page("truth.html", "Truth set", 26, _content)
