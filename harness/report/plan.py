"""The plan, as the page tells it: which stages every point keeps, which are left out, and why."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from harness.report.quantity import number, plural
from harness.report.series import Arrangement, Series

_NUMBER = re.compile(r"\d+(?:\.\d+)?")


@dataclass(frozen=True)
class StageRow:
    """One stage with what became of it, and the points it is so for."""

    name: str
    kept: bool
    why: str
    where: str


def stages(arrangement: Arrangement) -> list[StageRow]:
    """Every stage in the order of the pipeline; one that differs between points appears once for each way it goes.

    Reasons that differ in their numbers only are one way: "all 10 … 780 pairs".
    """
    order: dict[str, dict[tuple[bool, str], list[tuple[str, str]]]] = {}
    for point in arrangement.points:
        for stage in point.row.plan.get("stages") or ():
            why = str(stage.get("why") or "")
            way = (bool(stage["kept"]), _NUMBER.sub("#", why))
            order.setdefault(str(stage["name"]), {}).setdefault(way, []).append((point.row.key, why))
    return [
        StageRow(name, kept, _merged([why for _, why in points]), _where(arrangement, [key for key, _ in points]))
        for name, ways in order.items()
        for (kept, _), points in ways.items()
    ]


def _merged(reasons: Sequence[str]) -> str:
    """Reasons alike but for their numbers as one, each number as its range."""
    columns = zip(*(_NUMBER.findall(reason) for reason in reasons), strict=True)
    spans = [list(dict.fromkeys((min(column, key=float), max(column, key=float)))) for column in columns]
    numbers = iter([" … ".join(span) for span in spans])
    return _NUMBER.sub(lambda _: next(numbers), reasons[0])


def _where(arrangement: Arrangement, keys: Sequence[str]) -> str:
    """The points in words: all, whole series by name, or how many."""
    wanted = set(keys)
    total = len(arrangement.points)
    if len(wanted) == total:
        return "all points"
    whole = [series for series in arrangement.series if {point.row.key for point in series.points} <= wanted]
    if sum(len(series.points) for series in whole) == len(wanted) and len(whole) <= 4:
        return "; ".join(_named(series) for series in whole)
    return f"{number(len(wanted))} of {plural(total, 'point')}"


def _named(series: Series) -> str:
    return f"{series.label}, {series.panel}" if series.panel else series.label
