"""The atlas of correctness: every engine on families of poses, each verdict held against exact arithmetic."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.report.atlas import AtlasPart, AtlasResults
from harness.report.figure import figures_of
from harness.report.page import Content, Page
from harness.report.quantity import number
from harness.report.results import Results
from harness.report.sentences.atlas import atlas_sentences
from harness.report.table import Column, Entry, Table, counted, counted_bad, plain, words
from harness.vocabulary import FAMILIES


def _content(results: Results) -> Content | None:
    atlas = AtlasResults.of(results.compared)
    if not atlas.records:
        return None
    figures = figures_of("atlas", atlas)
    parts = [
        (part, figure, _table(part), _cases(part)) for part, figure in zip(atlas.parts, figures["matrix"], strict=True)
    ]
    seen = {family for part in atlas.parts for family in part.families}
    values = {
        "summary": atlas_sentences(atlas.parts),
        "parts": parts,
        "overall": figures["overall"],
        "families": [(family, FAMILIES[family]) for family in FAMILIES if family in seen],
        "notes": list(dict.fromkeys(line for r in atlas.records for line in r.document["unsupported"])),
        "left_out": list(dict.fromkeys(line for r in atlas.records for line in r.document["left_out"])),
        "commands": list(dict.fromkeys(record.command for record in atlas.records)),
    }
    return Content("atlas.html.j2", values, results.records, [*figures["overall"], *figures["matrix"]], atlas.files)


def _table(part: AtlasPart) -> Table:
    rows = tuple(
        _row(engine, family, part.cells[engine, family])
        for engine in part.engines
        for family in part.families
        if (engine, family) in part.cells
    )
    columns = (
        Column("Engine", numeric=False), Column("Family", numeric=False), Column("verdicts"), Column("wrong"),
        Column("in a million"), Column("beyond tolerance"), Column("farthest", "of size"), Column("a query", "µs CPU"),
        Column("failures"),
    )  # fmt: skip
    note = (
        "Small print is the interval that holds the rate in 95 % (Clopper and Pearson). “Farthest” is the largest gap "
        "or overlap about which a verdict was wrong; of distances the largest error, and of a tolerance the largest "
        "difference of a gap from the limit. A query is one pose of two bodies, asked right after another."
    )
    return Table(f"{part.experiment}, {part.title}", note, columns, rows)


def _row(engine: str, family: str, cell: Mapping[str, Any]) -> tuple[Entry, ...]:
    rate = cell["per_million"]
    interval = "" if rate is None else f"[{number(cell['low'])}, {number(cell['high'])}]"
    return (
        words(engine),
        words(family),
        counted(cell["verdicts"]),
        counted(cell["wrong"]),
        Entry(number(rate), small=interval, sort=plain(rate)),
        counted_bad(cell["beyond"]),
        counted(cell["deepest"]),
        Entry(number(1e6 * cell["seconds"]) if cell["seconds"] else "", sort=plain(cell["seconds"])),
        counted_bad(cell["failures"]),
    )


def _cases(part: AtlasPart) -> list[tuple[str, str, list[str]]]:
    """(engine and family, file or "", sentences) of the smallest cases."""
    found = sorted((place, cell["file"], cell["sentences"]) for place, cell in part.cells.items())
    return [(f"{engine}, {family}", file, sentences) for (engine, family), file, sentences in found if sentences]


PAGE = Page("atlas.html", "Atlas", 25, _content)
