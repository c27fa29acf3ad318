"""What an atlas found: engines on families of poses, every answer held against exact arithmetic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.report.atlas import AtlasPart
from harness.report.quantity import number, plural


def atlas_sentences(parts: Sequence[AtlasPart]) -> list[str]:
    """How many answers there were, who was wrong, and who never was; query by query."""
    cells = [cell for part in parts if part.query == "collision" for cell in part.cells.values()]
    said = _on_collisions(cells) if cells else []
    for query in dict.fromkeys(part.query for part in parts if part.query != "collision"):
        said += _on_gaps(query, [cell for part in parts if part.query == query for cell in part.cells.values()])
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
    return [*said, f"Off by no more than their tolerance in any of them: {', '.join(right)}."] if right else said


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
        said.append(f"Wrong about none of these poses beyond their tolerance: {', '.join(right)}.")
    return said
