"""An experiment's points arranged for reading: one leaf along x, one series for every combination of the others.

A series is what a figure draws as a line and a table as a row. Where there are too many for one picture they are split
into panels by a leaf of the scene; so they are where methods are compared on several scenes.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from harness.measure.noise import noise_floor
from harness.measure.statistics import Summary, summary
from harness.report.words import setting
from harness.store.records import ControlRecord, ExperimentRecord, PointRow
from harness.vocabulary import METHOD_LEAVES, MethodName

MOST_IN_A_PANEL = 6
DEFAULT_METRICS = ("pair_seconds", "box_seconds")


@dataclass(frozen=True, eq=False)
class MeasuredPoint:
    """One point of an experiment with all its runs, failed ones included.

    Parameters
    ----------
    row : as it is stored
    runs : a row a run, by repeat
    proven_wrong : whether its method was proven wrong at poses of this experiment, or failed at them
    """

    row: PointRow
    runs: pd.DataFrame
    proven_wrong: bool = False

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Its leaves, and what is derived from them."""
        return self.row.parameters

    @property
    def scene(self) -> dict[str, Any]:
        """Those of its leaves that are not the method's."""
        return {leaf: value for leaf, value in self.parameters.items() if leaf not in METHOD_LEAVES}

    @cached_property
    def good(self) -> pd.DataFrame:
        """The runs that came to their end."""
        ended: pd.DataFrame = self.runs[self.runs["status"] == "ok"]
        return ended

    def values(self, metric: str) -> npt.NDArray[np.float64]:
        """The metric of every good run that reports it, by repeat."""
        if metric not in self._values:
            column = self.good[metric] if metric in self.good.columns else ()
            values = np.asarray(column, dtype=float)
            self._values[metric] = values[np.isfinite(values)]
        return self._values[metric]

    def by_place(self, metric: str) -> dict[tuple[int, str], float]:
        """The metric of every good run that reports it, by repeat and machine.

        To be paired with another point's: times of two machines are not compared.
        """
        if metric not in self.good.columns:
            return {}
        rows = zip(self.good["repeat"], self.good["machine"], self.good[metric], strict=True)
        return {(int(repeat), str(machine)): float(value) for repeat, machine, value in rows if math.isfinite(value)}

    def summary(self, metric: str) -> Summary | None:
        """Median and interval of the metric, None where no good run reports it."""
        if metric not in self._summaries:
            values = self.values(metric)
            self._summaries[metric] = summary(values) if len(values) else None
        return self._summaries[metric]

    def median(self, metric: str) -> float:
        """Median of the metric, nan where no good run reports it."""
        found = self.summary(metric)
        return found.median if found else math.nan

    @property
    def disagrees(self) -> bool:
        """Whether a run's hits differ from the reference's."""
        return any(bool((self.values(metric) > 0).any()) for metric in ("missed_hits", "extra_hits"))

    @property
    def is_wrong(self) -> bool:
        """Whether its answers are known to be wrong: such a point is shown struck through, and never ranked."""
        return self.proven_wrong or self.disagrees

    @cached_property
    def _values(self) -> dict[str, npt.NDArray[np.float64]]:
        return {}

    @cached_property
    def _summaries(self) -> dict[str, Summary | None]:
        return {}


@dataclass(frozen=True)
class Series:
    """Points that differ in x only. `style` numbers the colour and marker, the same on all of a page."""

    label: str
    style: int
    panel: str
    points: tuple[MeasuredPoint, ...]
    x: tuple[Any, ...]

    def at(self, x: object) -> MeasuredPoint | None:
        """The point at a value of x."""
        wanted = _hashable(x)
        return next(
            (point for point, value in zip(self.points, self.x, strict=True) if _hashable(value) == wanted), None
        )

    def shares_scenes_with(self, other: Series) -> bool:
        """Whether the two are methods put to the same scenes, wherever they share an x."""
        theirs = dict(zip(map(_hashable, other.x), other.points, strict=True))
        pairs = [(point, theirs.get(_hashable(x))) for point, x in zip(self.points, self.x, strict=True)]
        return all(mine.scene == match.scene for mine, match in pairs if match is not None)


@dataclass(frozen=True)
class Arrangement:
    """An experiment's series over its x leaf; x is None where nothing is swept."""

    x: str | None
    x_values: tuple[Any, ...]
    series: tuple[Series, ...]
    panel_leaf: str | None
    metrics: tuple[str, ...]
    floors: Mapping[str, float] = field(default_factory=dict)
    controls: int = 0

    def floor(self, metric: str) -> float:
        """How far apart, relatively, two equal points may seem in this metric; 0 where no control tells."""
        return self.floors.get(metric, 0.0)

    @property
    def numeric(self) -> bool:
        """Whether x is a number, so that distances along it mean something."""
        return all(_is_number(value) for value in self.x_values)

    @property
    def panels(self) -> tuple[str, ...]:
        """Names of the panels, in order; one empty name where the series were not split."""
        return tuple(dict.fromkeys(series.panel for series in self.series))

    @property
    def methods(self) -> tuple[Series, ...]:
        """What can be ranked: the series, or, where one series runs over methods, each of its points as one."""
        if len(self.series) > 1 or self.numeric or self.x not in METHOD_LEAVES:
            return self.series
        line = self.series[0]
        return tuple(
            Series(setting(self.x, value), place, line.panel, (point,), (value,))
            for place, (point, value) in enumerate(zip(line.points, line.x, strict=True))
        )

    @property
    def points(self) -> list[MeasuredPoint]:
        """All points, series by series."""
        return [point for series in self.series for point in series.points]


def arrange(
    record: ExperimentRecord,
    runs: pd.DataFrame,
    controls: Sequence[ControlRecord] = (),
    wrong: Collection[MethodName] = (),
) -> Arrangement:
    """Arrange an experiment's points.

    Parameters
    ----------
    record : of the experiment
    runs : rows of the run table that belong to it
    controls : of its points
    wrong : methods that were proven wrong at its poses
    """
    by_point = dict(tuple(runs.sort_values(["repeat", "sweep"], kind="stable").groupby("point", sort=False)))
    nothing = runs.iloc[:0]
    points = [
        MeasuredPoint(row, by_point.get(row.key, nothing), bool(wrong) and MethodName.of(row.parameters) in wrong)
        for row in record.points
    ]
    report: Mapping[str, Any] = record.specification.get("report") or {}
    swept = [leaf for leaf in record.specification.get("swept") or () if _spread(points, leaf) > 1]
    x = _x_leaf(points, swept, report.get("x"))
    others = [leaf for leaf in swept if leaf != x and not _follows(points, leaf, x)]
    panel_leaf = _panel_leaf(points, others)
    lines: dict[str, list[MeasuredPoint]] = {}
    for point in points:
        lines.setdefault(_key(point, others), []).append(point)
    names = [leaf for leaf in others if leaf != panel_leaf]
    styles: dict[str, int] = {}
    series = []
    for members in lines.values():
        first = members[0].parameters
        label = _label(first, names)
        members = sorted(members, key=lambda point: _order(point.parameters.get(x))) if x else members
        series.append(
            Series(
                label,
                styles.setdefault(label, len(styles)),
                setting(panel_leaf, first.get(panel_leaf)) if panel_leaf else "",
                tuple(members),
                tuple(point.parameters.get(x) for point in members) if x else tuple(None for _ in members),
            )
        )
    values = {_hashable(point.parameters.get(x)): point.parameters.get(x) for point in points} if x else {}
    y = report.get("y") or DEFAULT_METRICS
    return Arrangement(
        x,
        tuple(sorted(values.values(), key=_order)),
        tuple(series),
        panel_leaf,
        (y,) if isinstance(y, str) else tuple(y),
        *_floors(points, controls),
    )


def _floors(points: Sequence[MeasuredPoint], controls: Sequence[ControlRecord]) -> tuple[dict[str, float], int]:
    """The noise floor of every clock that the controls report, and how many pairs there are."""
    of_point = {point.row.key: point for point in points}
    pairs: dict[str, list[tuple[float, float]]] = {}
    for control in controls:
        point = of_point.get(control.point)
        for metric, value in control.metrics.items() if point else ():
            first = point.by_place(metric).get((control.repeat, control.machine)) if point else None
            if first is not None:
                pairs.setdefault(metric, []).append((first, value))
    floors = {metric: noise_floor(*zip(*found, strict=True)) for metric, found in pairs.items()}
    known = {metric: floor for metric, floor in floors.items() if floor is not None}
    return known, max(map(len, pairs.values()), default=0)


def _x_leaf(points: Sequence[MeasuredPoint], swept: Sequence[str], wanted: str | None) -> str | None:
    if wanted and _spread(points, wanted) > 0:
        return wanted
    numeric = [leaf for leaf in swept if all(_is_number(point.parameters.get(leaf)) for point in points)]
    # where no leaf is a number, what the method is tells more as series than along x
    return next(iter(numeric or [leaf for leaf in swept if leaf not in METHOD_LEAVES] or swept), None)


def _panel_leaf(points: Sequence[MeasuredPoint], others: Sequence[str]) -> str | None:
    scene = [leaf for leaf in others if leaf not in METHOD_LEAVES]
    mixed = 0 < len(scene) < len(others)  # methods are compared on the same scene
    if len(others) < 2 or not (mixed or len({_key(point, others) for point in points}) > MOST_IN_A_PANEL):
        return None
    scene = scene or list(others)
    return min(scene, key=lambda leaf: (_spread(points, leaf) > 8, -_spread(points, leaf)))


def _label(parameters: Mapping[str, Any], leaves: Sequence[str]) -> str:
    """The swept leaves' values; where none is left, what the method is."""
    named = leaves or [leaf for leaf in ("backend", "algorithm") if leaf in parameters]
    return "\u00a0· ".join(setting(leaf, parameters.get(leaf)) for leaf in named) or "this scene"


def _follows(points: Sequence[MeasuredPoint], leaf: str, x: str | None) -> bool:
    """Whether x determines the leaf, as `faces` does the mesh: it is then no series of its own."""
    if x is None:
        return False
    return len({_key(point, (x, leaf)) for point in points}) == _spread(points, x)


def _spread(points: Sequence[MeasuredPoint], leaf: str) -> int:
    """How many values the leaf takes."""
    return len({_key(point, (leaf,)) for point in points if leaf in point.parameters})


def _key(point: MeasuredPoint, leaves: Sequence[str]) -> str:
    return json.dumps([point.parameters.get(leaf) for leaf in leaves], sort_keys=True)


def _hashable(value: object) -> object:
    return value if isinstance(value, int | float | str | None) else json.dumps(value, sort_keys=True)


def _order(value: object) -> tuple[int, float]:
    """Numbers by size; anything else keeps the order of the file (sorting is stable)."""
    return (0, float(value)) if isinstance(value, int | float) and not isinstance(value, bool) else (1, 0.0)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
