"""All the differences that a report may name, looked at together: what p-value makes one of them count.

The family of a report is every pair of methods at every scene, in every clock that its pages rank; every change of a
clock from one end of x to the other; and every pair of settings that reach an error. A larger report looks at more
pairs, and of equal pairs some come far apart by chance alone; so the level that a pair must keep is set for all of them
at once. It is no smaller than the rate of one pair by itself where nearly all differences are real, and far smaller
where few are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from harness.measure.noise import level
from harness.measure.statistics import FEWEST_FOR_INTERVAL
from harness.report.accuracy.tradeoffs import COST, tradeoffs
from harness.report.point import MeasuredPoint
from harness.report.ranking import change_p_value, paired
from harness.report.series import Arrangement
from harness.report.words import is_noisy, is_ranked
from harness.store.records import ExperimentRecord

# Clocks that pages rank whatever an experiment asks for: of the accuracy page, and of the page of backends.
_ALWAYS = (COST, "pair_seconds_per_frame")

Measured = tuple[ExperimentRecord, Arrangement]


@dataclass(frozen=True, eq=False)
class Family:
    """The comparisons of all experiments of a report.

    Parameters
    ----------
    members : gives every experiment with its arrangement, when it is first asked for them
    """

    members: Callable[[], Sequence[Measured]]

    @cached_property
    def level(self) -> float:
        """The largest p-value of a difference that is called one."""
        return level(self.p_values)

    @cached_property
    def p_values(self) -> list[float]:
        """Of every pair of which something can be told."""
        return [p for record, arrangement in self.members() for p in _p_values(record, arrangement)]


def _p_values(record: ExperimentRecord, arrangement: Arrangement) -> Iterator[float]:
    lone = arrangement.series[0].points if len(arrangement.series) == 1 else ()
    for metric in dict.fromkeys((*arrangement.metrics, *_ALWAYS)):
        resolution = arrangement.resolution(metric)
        if not is_noisy(metric) or not is_ranked(metric):
            continue
        if resolution.control is None:
            if len(lone) > 1 and len(paired(lone[-1], lone[0], metric)) >= FEWEST_FOR_INTERVAL:
                yield change_p_value(lone[-1], lone[0], metric)
            continue
        pairs = {_key(a, b): (a, b) for a, b in _pairs(arrangement)}
        if len(lone) > 1:
            pairs[_key(lone[0], lone[-1])] = lone[0], lone[-1]
        if metric == COST:
            pairs |= {_key(a, b): (a, b) for a, b in _settings(record, arrangement)}
        for a, b in pairs.values():
            if a.can_be_ranked and b.can_be_ranked:
                p = resolution.p_value(paired(a, b, metric))
                if p is not None:
                    yield p


def _pairs(arrangement: Arrangement) -> Iterator[tuple[MeasuredPoint, MeasuredPoint]]:
    """Points that differ by their series alone."""
    methods = arrangement.methods
    for panel in arrangement.panels:
        lines = [series for series in methods if series.panel == panel]
        xs = (arrangement.x_values or (None,)) if methods is arrangement.series else (None,)
        for x in xs:
            points = [line.points[0] if x is None else line.at(x) for line in lines]
            yield from combinations([point for point in points if point is not None], 2)


def _settings(record: ExperimentRecord, arrangement: Arrangement) -> Iterator[tuple[MeasuredPoint, MeasuredPoint]]:
    """The settings that reach an error, each method's cheapest."""
    for tradeoff in tradeoffs(record, arrangement):
        for target in tradeoff.kind.targets:
            yield from combinations([found.point for _, found in tradeoff.ranked(target)], 2)


def _key(a: MeasuredPoint, b: MeasuredPoint) -> tuple[str, str]:
    return a.row.key, b.row.key
