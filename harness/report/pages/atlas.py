"""The atlas of correctness: every engine on families of poses, each verdict held against exact arithmetic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.report.atlas import AtlasPart, AtlasResults
from harness.report.figure import figures_of
from harness.report.page import Content, Page
from harness.report.quantity import number, plural
from harness.report.results import Results
from harness.report.table import Column, Entry, Table, plain, words
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
        "summary": _summary(atlas),
        "parts": parts,
        "overall": figures["overall"],
        "families": [(family, FAMILIES[family]) for family in FAMILIES if family in seen],
        "notes": list(dict.fromkeys(line for r in atlas.records for line in r.document["unsupported"])),
        "left_out": list(dict.fromkeys(line for r in atlas.records for line in r.document["left_out"])),
        "commands": list(dict.fromkeys(record.command for record in atlas.records)),
    }
    return Content("atlas.html.j2", values, results.records, [*figures["overall"], *figures["matrix"]], atlas.files)


def _summary(atlas: AtlasResults) -> list[str]:
    cells = [cell for part in atlas.parts if part.query == "collision" for cell in part.cells.values()]
    said = _on_collisions(cells) if cells else []
    for query in dict.fromkeys(part.query for part in atlas.parts if part.query != "collision"):
        said += _on_gaps(query, [cell for part in atlas.parts if part.query == query for cell in part.cells.values()])
    return said


def _on_gaps(query: str, cells: Sequence[Mapping[str, Any]]) -> list[str]:
    """What was found of gaps, or of whether bodies are near."""
    verdicts, beyond = sum(cell["verdicts"] for cell in cells), sum(cell["beyond"] for cell in cells)
    said = [
        f"Asked for the {query}: {plural(verdicts, 'answer')}, each held against exact distances: {number(beyond)} are "
        "off by more than the engine's tolerance."
    ]
    engines = sorted({cell["engine"] for cell in cells})
    for engine in engines:
        mine = [cell for cell in cells if cell["engine"] == engine and cell["beyond"]]
        if mine:
            worst = max(mine, key=lambda cell: cell["deepest"])
            count = plural(sum(cell["beyond"] for cell in mine), "answer")
            said.append(
                f"{engine} is off by more than its tolerance in {count} on {query}, by {number(worst['deepest'])} of a "
                f"size at the most ({worst['family']})."
            )
    right = [engine for engine in engines if not any(cell["beyond"] for cell in cells if cell["engine"] == engine)]
    return [*said, f"Never off by more than their tolerance: {', '.join(right)}."] if right else said


def _on_collisions(cells: Sequence[Mapping[str, Any]]) -> list[str]:
    verdicts, wrong = sum(cell["verdicts"] for cell in cells), sum(cell["wrong"] for cell in cells)
    beyond = sum(cell["beyond"] for cell in cells)
    said = [
        f"{plural(verdicts, 'verdict')}, each held against exact arithmetic: {number(wrong)} are wrong, "
        f"{number(beyond)} of them by more than the engine's tolerance."
    ]
    for engine in sorted({cell["engine"] for cell in cells}):
        mine = [cell for cell in cells if cell["engine"] == engine]
        worst = max(mine, key=lambda cell: (cell["beyond"] > 0, cell["deepest"]))
        if worst["beyond"]:
            said.append(
                f"{engine} is wrong about {plural(sum(cell['beyond'] for cell in mine), 'pose')} beyond its tolerance, "
                f"the farthest {number(worst['deepest'])} of a size from touching ({worst['family']})."
            )
    right = sorted({cell["engine"] for cell in cells} - {cell["engine"] for cell in cells if cell["beyond"]})
    if right:
        said.append(f"Never wrong beyond their tolerance: {', '.join(right)}.")
    return said


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
        Entry(number(cell["verdicts"]), sort=plain(cell["verdicts"])),
        Entry(number(cell["wrong"]), sort=plain(cell["wrong"])),
        Entry(number(rate), small=interval, sort=plain(rate)),
        _bad(cell["beyond"]),
        Entry(number(cell["deepest"]), sort=plain(cell["deepest"])),
        Entry(number(1e6 * cell["seconds"]) if cell["seconds"] else "", sort=plain(cell["seconds"])),
        _bad(cell["failures"]),
    )


def _bad(count: int) -> Entry:
    return Entry("", flag=number(count), sort=plain(count)) if count else Entry("0", sort=0.0)


def _cases(part: AtlasPart) -> list[tuple[str, str, list[str]]]:
    """(engine and family, file or "", sentences) of the smallest cases."""
    found = sorted((place, cell["file"], cell["sentences"]) for place, cell in part.cells.items())
    return [(f"{engine}, {family}", file, sentences) for (engine, family), file, sentences in found if sentences]


PAGE = Page("atlas.html", "Atlas", 25, _content)
