"""Who is fastest, and by how much: ratios of paired repeats, and growth exponents of every series."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from harness.measure.noise import student
from harness.measure.resolution import Distinction, Resolution
from harness.measure.statistics import (
    FEWEST_FOR_INTERVAL,
    Exponent,
    Summary,
    fit_exponent,
    paired_ratios,
    summary,
)
from harness.report.point import MeasuredPoint
from harness.report.series import Arrangement, Series
from harness.report.words import more_is_better

# Relative. Without a control, no smaller change of a clock is called one.
_UNCONTROLLED = 0.1


@dataclass(frozen=True)
class Ranked:
    """One series at one x.

    Parameters
    ----------
    ratio : how many times worse than the best it is; None of the best, and where nothing can be paired
    distinction : whether that ratio is told from 1
    """

    series: Series
    point: MeasuredPoint
    median: float
    ratio: Summary | None
    best: bool
    distinction: Distinction = "same"

    @property
    def tied(self) -> bool:
        """Whether it is the best, or cannot be told apart from it."""
        return self.best or self.distinction != "apart"


@dataclass(frozen=True)
class Growth:
    """The exponent with which a metric of a series grows over x."""

    series: Series
    metric: str
    exponent: Exponent


def rank(series: Sequence[Series], x: object, metric: str, resolution: Resolution) -> list[Ranked]:
    """The series that have the metric at x (None: anywhere), the best median first.

    Left out: what is known to be wrong, because a faster answer that is wrong is not faster; and, among others, what
    answers for another shape than that of the bodies. Whether the order means anything, `unranked` says.
    """
    found = []
    for line in series:
        point = line.points[0] if x is None else line.at(x)
        if point is not None and math.isfinite(point.median(metric)) and point.can_be_ranked:
            found.append((line, point, point.median(metric)))
    found = [(line, point, median) for line, point, median in found if not point.replaces_shape] or found
    if not found:
        return []
    found.sort(key=lambda entry: entry[-1], reverse=more_is_better(metric))
    _, best, _ = found[0]
    return [
        Ranked(line, point, median, None, True)
        if point is best
        else Ranked(
            line, point, median, times_worse(point, best, metric), False, tell_apart(point, best, metric, resolution)
        )
        for line, point, median in found
    ]


def unranked(distinctions: Iterable[Distinction]) -> str:
    """Why nobody is ahead of the others, from what was told of each against the best; "" where somebody may be."""
    found = set(distinctions)
    if "few" in found:
        return f"too few repeats to rank (fewer than {FEWEST_FOR_INTERVAL} pairs)"
    return "no control to rank by" if "uncontrolled" in found else ""


def tell_apart(point: MeasuredPoint, best: MeasuredPoint, metric: str, resolution: Resolution) -> Distinction:
    """Whether two points are told apart in a metric."""
    return resolution.tell(paired(point, best, metric))


def times_worse(point: MeasuredPoint, best: MeasuredPoint, metric: str) -> Summary | None:
    """How many times the metric of `point` is worse than that of `best`, over the repeats that both have.

    Repeats are paired that ran on the same machine.
    """
    ratio = summary(paired(point, best, metric))
    return ratio if ratio.n else None


def paired(point: MeasuredPoint, best: MeasuredPoint, metric: str) -> npt.NDArray[np.float64]:
    """The same, repeat by repeat; NaN where both are 0."""
    mine, theirs = point.by_place(metric), best.by_place(metric)
    shared = sorted(mine.keys() & theirs.keys())
    a, b = np.array([mine[place] for place in shared]), np.array([theirs[place] for place in shared])
    return paired_ratios(b, a) if more_is_better(metric) else paired_ratios(a, b)


def change_p_value(last: MeasuredPoint, first: MeasuredPoint, metric: str) -> float:
    """The p-value of a change of a clock without a control: of one that is larger than the noise of any."""
    ratios = paired(last, first, metric)
    return student(np.log(ratios[np.isfinite(ratios) & (ratios > 0.0)]), math.log1p(_UNCONTROLLED))


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
