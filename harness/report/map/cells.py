"""The cells of a map: at each value of two leaves, who is fastest of those that are right there, and how sure that is.

A cell is decided as everywhere in the report: what is known to be wrong, or disputed, is left out, and the fastest is
told from the others by paired repeats, a control and the level of the whole report. A map is of one shape, one query
and one accuracy: how exactly a method tells the time of a hit. A stepped method tells it to its time step; of each the
longest step that suffices is on the map.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from harness.report.experiment import ExperimentPage
from harness.report.quantity import leaf_text
from harness.report.ranking import Ranked, rank, unranked
from harness.report.series import Arrangement, Series, hashable
from harness.report.styles import letter
from harness.vocabulary import MethodName


@dataclass(frozen=True)
class MapCell:
    """One cell of a map.

    Parameters
    ----------
    x, y : values of the leaves
    ranked : the methods, the fastest first; empty where none was measured, or none is right
    """

    x: Any
    y: Any
    ranked: tuple[Ranked, ...]

    @property
    def best(self) -> Ranked | None:
        """The fastest, by the median."""
        return self.ranked[0] if self.ranked else None

    @property
    def runner_up(self) -> Ranked | None:
        """The second."""
        return self.ranked[1] if len(self.ranked) > 1 else None

    @property
    def doubt(self) -> str:
        """Why the fastest cannot be told; "" where it can."""
        if len(self.ranked) < 2:
            return "" if self.ranked else "not measured, or nobody is right"
        if self.decided:
            return ""
        why = unranked(entry.distinction for entry in self.ranked if entry.distinction != "apart")
        tied = " and ".join(method_of(entry.series).label for entry in self.ranked if entry.tied)
        return why or f"{tied} cannot be told apart"

    @property
    def decided(self) -> bool:
        """Whether the fastest is ahead of every other."""
        return len(self.ranked) == 1 or bool(self.ranked and not any(entry.tied for entry in self.ranked[1:]))


@dataclass(frozen=True, eq=False)
class MethodMap:
    """The fastest methods of one shape, query and accuracy.

    Parameters
    ----------
    name : unique in the report
    page : of the experiment that it is made of
    accuracy : s, to which the time of a hit is known at least; 0 where only methods that compute events are on it
    """

    name: str
    page: ExperimentPage
    shape: str
    query: str
    accuracy: float
    x_leaf: str
    y_leaf: str
    metric: str
    cells: tuple[MapCell, ...]

    @property
    def title(self) -> str:
        """What it is of."""
        return f"{self.kind}, {self.accuracy_text}"

    @property
    def kind(self) -> str:
        """Bodies and question."""
        bodies = {"sphere": "Spheres", "hull": "Convex bodies", "mesh": "Concave bodies"}.get(self.shape, self.shape)
        return bodies if self.query == "collision" else f"{bodies}, query {self.query}"

    @property
    def accuracy_text(self) -> str:
        """How exactly times of hits are known."""
        return f"times to {leaf_text(self.accuracy)} s" if self.accuracy else "exact times"

    @cached_property
    def xs(self) -> list[Any]:
        """Values of x, in order."""
        return sorted({cell.x for cell in self.cells}, key=_numbers_first)

    @cached_property
    def ys(self) -> list[Any]:
        """Values of y, in order."""
        return sorted({cell.y for cell in self.cells}, key=_numbers_first)

    @cached_property
    def winners(self) -> list[MethodName]:
        """The methods that are fastest somewhere."""
        return list(dict.fromkeys(method_of(cell.best.series) for cell in self.cells if cell.best))

    @cached_property
    def letters(self) -> dict[MethodName, str]:
        """By which each is known on the map."""
        return {method: letter(method) for method in self.winners}


def _numbers_first(value: Any) -> tuple[bool, Any]:
    """By which values of a leaf are sorted, some of which may be words."""
    return isinstance(value, str), value


def maps_of(pages: Iterable[ExperimentPage]) -> list[MethodMap]:
    """Every map that the experiments declare."""
    return [made for page in pages for made in _maps(page)]


def method_of(series: Series) -> MethodName:
    """The method of a series."""
    return MethodName.of(series.points[0].parameters)


def time_accuracy(series: Series) -> float:
    """To what it tells the time of a hit, s; 0 where it computes events or asks for times."""
    method = method_of(series)
    if not method.stepped or method.query == "impact":
        return 0.0
    return float(series.points[0].parameters.get("dt", 0.0))


def _maps(page: ExperimentPage) -> Iterable[MethodMap]:
    axes = (page.record.specification.get("report") or {}).get("map")
    arrangement = page.arrangement
    if not axes or not any(not point.good.empty for point in arrangement.points):
        return
    kinds = dict.fromkeys((method_of(line).shape, method_of(line).query) for line in arrangement.series)
    for shape, query in kinds:
        lines = [
            line for line in arrangement.series if (method_of(line).shape, method_of(line).query) == (shape, query)
        ]
        steps = sorted({time_accuracy(line) for line in lines} - {0.0}, reverse=True) or [0.0]
        for place, accuracy in enumerate(steps):
            yield MethodMap(
                f"{page.record.name}-{shape}-{query}-{place}".replace("/", "-"),
                page,
                shape,
                query,
                accuracy,
                axes["x"],
                axes["y"],
                arrangement.metrics[0],
                tuple(_cells(arrangement, _sufficient(lines, accuracy), axes["y"])),
            )


def _sufficient(lines: Sequence[Series], accuracy: float) -> list[Series]:
    """Of each method the series with the longest step that is exact enough."""
    longest: dict[tuple[MethodName, str], Series] = {}
    for line in sorted(lines, key=time_accuracy):
        if time_accuracy(line) <= accuracy:
            longest[method_of(line), line.panel] = line
    return list(longest.values())


def _cells(arrangement: Arrangement, lines: Sequence[Series], y_leaf: str) -> Iterable[MapCell]:
    resolution = arrangement.resolution(arrangement.metrics[0])
    for panel in arrangement.panels:
        inside = [line for line in lines if line.panel == panel]
        if not inside:
            continue
        y = _rounded(inside[0].points[0].value(y_leaf))
        for x in arrangement.x_values:
            if any(line.at(x) is not None for line in inside):
                ranked = rank(inside, x, arrangement.metrics[0], resolution)
                yield MapCell(hashable(x), y, tuple(ranked))


def _rounded(value: Any) -> Any:
    """A number to the six digits by which panels are told apart."""
    return float(f"{value:.6g}") if isinstance(value, float) else hashable(value)
