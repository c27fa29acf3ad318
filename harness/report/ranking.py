"""Who is fastest, and by how much: ratios of paired repeats, and growth exponents of every series."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from harness.measure.noise import distinguishable
from harness.measure.statistics import Exponent, Summary, fit_exponent, paired_ratio
from harness.report.point import MeasuredPoint
from harness.report.series import Arrangement, Series
from harness.report.words import more_is_better


@dataclass(frozen=True)
class Ranked:
    """One series at one x. `behind` is how many times worse than the best it is, None where nothing can be paired."""

    series: Series
    point: MeasuredPoint
    median: float
    behind: Summary | None
    best: bool
    floor: float = 0.0

    @property
    def level(self) -> bool:
        """Whether it is the best, or not to be told from it: the ratio's interval is not beyond the noise floor."""
        return self.best or (self.behind is not None and not distinguishable(self.behind, self.floor))


@dataclass(frozen=True)
class Growth:
    """The exponent with which a metric of a series grows over x."""

    series: Series
    metric: str
    exponent: Exponent


def rank(series: Sequence[Series], x: object, metric: str, floor: float) -> list[Ranked]:
    """The series that have the metric at x (None: anywhere), best first; `floor` is the noise floor of the metric.

    Left out: what is known to be wrong, because a faster answer that is wrong is not faster.
    """
    found = []
    for line in series:
        point = line.points[0] if x is None else line.at(x)
        if point is not None and math.isfinite(point.median(metric)) and not point.is_wrong:
            found.append((line, point, point.median(metric)))
    found.sort(key=lambda entry: -entry[2] if more_is_better(metric) else entry[2])
    if not found:
        return []
    best = found[0][1]
    return [
        Ranked(line, point, median, None if point is best else times_worse(point, best, metric), point is best, floor)
        for line, point, median in found
    ]


def times_worse(point: MeasuredPoint, best: MeasuredPoint, metric: str) -> Summary | None:
    """How many times the metric of `point` is worse than that of `best`, over the repeats that both have.

    Repeats are paired that ran on the same machine.
    """
    mine, theirs = point.by_place(metric), best.by_place(metric)
    shared = sorted(mine.keys() & theirs.keys())
    if not shared:
        return None
    a, b = [mine[repeat] for repeat in shared], [theirs[repeat] for repeat in shared]
    ratio = paired_ratio(b, a) if more_is_better(metric) else paired_ratio(a, b)
    return ratio if ratio.n else None


def growth(arrangement: Arrangement, metrics: Sequence[str]) -> list[Growth]:
    """The exponents of every metric and series that has it at two values of x or more; nothing where x is no number."""
    if not arrangement.numeric or arrangement.x is None:
        return []
    found = []
    for metric in metrics:
        for line in arrangement.series:
            samples: dict[float, list[float]] = {}
            for point, x in zip(line.points, line.x, strict=True):
                samples.setdefault(float(x), []).extend(point.values(metric))
            exponent = fit_exponent({x: values for x, values in samples.items() if values})
            if exponent.n >= 2:
                found.append(Growth(line, metric, exponent))
    return found
