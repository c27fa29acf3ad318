"""What was found of all who were asked, as a table for a person and as a document."""

from __future__ import annotations

from collections.abc import Mapping
from statistics import median
from typing import Any

from harness.backends.registry import packages
from harness.measure.machine import package_versions, source_commit
from harness.truth.answerers import AskedEngine
from harness.truth.verdict import VERDICTS, FamilyCount, Verdicts

_HEADS = ("backend", "family", "asked", *VERDICTS, "latest", "earliest", "time a query")

Asked = Mapping[AskedEngine, Verdicts]


def table(asked: Asked) -> str:
    """A line a backend and family, and one for all families."""
    rows = [_HEADS]
    notes = []
    for engine, verdicts in asked.items():
        if verdicts.problem:
            notes.append(f"{engine.label}: not asked: {verdicts.problem}")
            continue
        rows += [_row(engine.label, family, count) for family, count in verdicts.named().items()]
        notes += [f"{engine.label}: {cases} cases failed: {why}" for why, cases in verdicts.failures.items()]
        if without := verdicts.total().without:
            notes.append(f"{engine.label}: {without} cases are of shapes that it does not have, and were not asked")
    widths = [max(len(row[column]) for row in rows) for column in range(len(_HEADS))]
    lines = ["  ".join(_aligned(cell, width, k) for k, (cell, width) in enumerate(zip(row, widths, strict=True)))
             for row in rows]  # fmt: skip
    return "\n".join([*(line.rstrip() for line in lines), *notes])


def document(asked: Asked, folder: str, within: float, every: int) -> dict[str, Any]:
    """For JSON: times in s, and what of the machine they depend on."""
    asking = _asking(folder, within, every)
    return asking | {"backends": [_answers(engine, verdicts) for engine, verdicts in asked.items()]}


def documents(asked: Asked, folder: str, within: float, every: int) -> dict[str, dict[str, Any]]:
    """What is kept in a database, by who was asked."""
    asking = _asking(folder, within, every)
    return {engine.label: {"truth": asking | _answers(engine, verdicts)} for engine, verdicts in asked.items()}


def _asking(folder: str, within: float, every: int) -> dict[str, Any]:
    return {
        "set": folder,
        "within": within,
        "every": every,
        "commit": source_commit(),
        "versions": package_versions(packages()),
    }


def _answers(engine: AskedEngine, verdicts: Verdicts) -> dict[str, Any]:
    return {
        "backend": engine.name,
        "dt": engine.dt or None,
        "problem": verdicts.problem or None,
        "failures": verdicts.failures,
        "families": {family: count.document() for family, count in verdicts.named().items()},
    }


def _row(label: str, family: str, count: FamilyCount) -> tuple[str, ...]:
    seconds = f"{median(count.seconds) * 1e3:.3g} ms" if count.seconds else "-"
    out = (f"{time:.2g} s" if time > 0.0 else "-" for time in (count.latest, count.earliest))
    return (label, family, str(count.asked), *(str(count.verdicts[verdict]) for verdict in VERDICTS), *out, seconds)


def _aligned(cell: str, width: int, column: int) -> str:
    return cell.ljust(width) if column < 2 else cell.rjust(width)
