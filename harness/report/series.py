"""An experiment's points arranged for reading: one leaf along x, one series for every combination of the others.

A series is what a figure draws as a line and a table as a row. Where there are too many for one picture they are split
into panels by a leaf of the scene; so they are where methods are compared on several scenes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from harness.measure.noise import FALSE_RATE, Control
from harness.measure.resolution import Resolution
from harness.report.methods import method_label
from harness.report.point import METHOD, MeasuredPoint
from harness.report.words import is_noisy
from harness.vocabulary import METHOD_LEAVES

Noise = Literal["low noise", "noisy", ""]

# Of an experiment's medians, how many must be known to 5 % for its noise to be called low.
_PRECISE_SHARE = 0.9


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
        wanted = hashable(x)
        return next(
            (point for point, value in zip(self.points, self.x, strict=True) if hashable(value) == wanted), None
        )

    def shares_scenes_with(self, other: Series) -> bool:
        """Whether the two are methods put to the same scenes, wherever they share an x."""
        theirs = dict(zip(map(hashable, other.x), other.points, strict=True))
        pairs = [(point, theirs.get(hashable(x))) for point, x in zip(self.points, self.x, strict=True)]
        return all(mine.scene == match.scene for mine, match in pairs if match is not None)


@dataclass(frozen=True)
class Arrangement:
    """An experiment's series over its x leaf; x is None where nothing is swept.

    `controls` are those of each clock, and `level` is the largest p-value at which two points are told apart.
    """

    x: str | None
    x_values: tuple[Any, ...]
    series: tuple[Series, ...]
    panel_leaf: str | None
    metrics: tuple[str, ...]
    controls: Mapping[str, Control] = field(default_factory=dict)
    level: float = FALSE_RATE

    def resolution(self, metric: str) -> Resolution:
        """What difference in a metric is called one."""
        return Resolution(self.controls.get(metric), self.level, exact=not is_noisy(metric))

    @property
    def noise(self) -> Noise:
        """Whether nine medians in ten are known to 5 %; "" where it cannot be said."""
        judged = [
            summary.precise
            for point in self.points
            for metric in self.metrics
            if is_noisy(metric) and (summary := point.summary(metric)) is not None and summary.precise is not None
        ]
        if not judged:
            return ""
        return "low noise" if sum(judged) >= _PRECISE_SHARE * len(judged) else "noisy"

    @property
    def numeric(self) -> bool:
        """Whether x is a number, so that distances along it mean something."""
        return all(is_number(value) for value in self.x_values)

    @property
    def panels(self) -> tuple[str, ...]:
        """Names of the panels, in order; one empty name where the series were not split."""
        return tuple(dict.fromkeys(series.panel for series in self.series))

    @property
    def methods(self) -> tuple[Series, ...]:
        """What can be ranked: the series, or, where one series runs over methods, each of its points as one."""
        if len(self.series) > 1 or self.numeric or self.x not in (METHOD, *METHOD_LEAVES):
            return self.series
        line = self.series[0]
        return tuple(
            Series(method_label(point.parameters, [self.x]), place, line.panel, (point,), (value,))
            for place, (point, value) in enumerate(zip(line.points, line.x, strict=True))
        )

    @property
    def points(self) -> list[MeasuredPoint]:
        """All points, series by series."""
        return [point for series in self.series for point in series.points]


def hashable(value: object) -> object:
    """A leaf's value as a key."""
    return value if isinstance(value, int | float | str | None) else json.dumps(value, sort_keys=True)


def in_a_panel(leaf: str, value: Any) -> Any:
    """A leaf's value as points share it: boxes that are written in a few digits make packings a little apart.

    >>> in_a_panel("packing", 0.0499997), in_a_panel("count", 50)
    (0.05, 50)
    """
    return float(f"{value:.3g}") if leaf == "packing" and is_number(value) else value


def is_number(value: object) -> bool:
    """Whether a leaf's value has a place on an axis."""
    return isinstance(value, int | float) and not isinstance(value, bool)
