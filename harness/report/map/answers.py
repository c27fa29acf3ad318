"""What a map says of each of its cells, in words: for a table, for the form beside the map and for a pointer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from harness.report.lines import median_text
from harness.report.map.cells import MapCell, MethodMap, method_of, time_accuracy
from harness.report.quantity import leaf_text, number, scale
from harness.report.ranking import Ranked
from harness.report.styles import style_of
from harness.report.words import metric_title, metric_unit
from harness.vocabulary import MethodName


@dataclass(frozen=True)
class Answer:
    """One cell in words.

    Parameters
    ----------
    x, y : as they are written
    method, cost, sure, second : the fastest, what it costs, how sure that is, and the runner-up with its ratio
    style, letter : of the method, as `harness.report.styles` has them
    yaml : the lines of an experiment that choose it
    """

    where: MethodMap
    cell: MapCell
    x: str
    y: str
    method: str = "nobody"
    style: int | None = None
    letter: str = ""
    cost: str = ""
    sure: str = ""
    second: str = ""
    yaml: str = ""

    @property
    def sentence(self) -> str:
        """All of it in a line, for a pointer over the cell."""
        parts = [f"{self.x}, {self.y}: {self.method}", self.cost, self.second, self.sure]
        return "; ".join(part for part in parts if part)


def answers(made: MethodMap) -> list[Answer]:
    """Of every cell of a map, row by row."""
    cells = sorted(made.cells, key=lambda cell: (made.ys.index(cell.y), made.xs.index(cell.x)))
    return [_answer(made, cell) for cell in cells]


def place_text(leaf: str, value: Any) -> str:
    """A value of a leaf as a person says it."""
    if leaf == "count":
        return f"{leaf_text(value)} bodies"
    return f"{leaf} {leaf_text(value)}"


def _answer(made: MethodMap, cell: MapCell) -> Answer:
    x, y = place_text(made.x_leaf, cell.x), place_text(made.y_leaf, cell.y)
    best = cell.best
    if best is None:
        return Answer(made, cell, x, y, sure=cell.doubt)
    method = method_of(best.series)
    return Answer(
        made,
        cell,
        x,
        y,
        method=method.label,
        style=style_of(method),
        letter=made.letters[method],
        cost=_cost(made, best),
        sure=_sure(cell),
        second=_second(cell),
        yaml=_yaml(method, time_accuracy(best.series)),
    )


def _cost(made: MethodMap, best: Ranked) -> str:
    found = best.point.summary(made.metric)
    if found is None:
        return ""
    unit = scale([found.median], metric_unit(made.metric))
    text = f"{metric_title(made.metric)} {median_text(found, unit)}"
    duration = best.point.parameters.get("duration")
    if made.metric == "run_seconds" and isinstance(duration, int | float):
        text += f", for {leaf_text(duration)} s of motion"
    return text


def _sure(cell: MapCell) -> str:
    if cell.doubt:
        return f"in doubt: {cell.doubt}"
    if len(cell.ranked) == 1:
        return "the only one measured here that is right"
    others = len(cell.ranked) - 1
    if others == 1:
        return "the two, which are all that are right here, are told apart"
    return f"told apart from all {others} others that are right here"


def _second(cell: MapCell) -> str:
    second = cell.runner_up
    if second is None:
        return ""
    name = method_of(second.series).label
    if second.ratio is None:
        return f"then {name}"
    kind = "range" if second.ratio.coverage is None else "interval"
    interval = f" ({kind} {number(second.ratio.low)} to {number(second.ratio.high)})" if second.ratio.n > 1 else ""
    return f"then {name}, {number(second.ratio.median)} times as much{interval}"


def _yaml(method: MethodName, step: float) -> str:
    query = f", query: {method.query}" if method.query != "collision" else ""
    engine = f"engine: {{backend: {method.backend}, algorithm: {method.algorithm}{query}}}"
    return engine if not method.stepped else f"{engine}\nmotion: {{dt: {leaf_text(step)}}}"
