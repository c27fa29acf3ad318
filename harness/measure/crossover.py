"""From which x on one method costs less than another."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.measure.statistics import Summary, summary

# x -> repeat (and where it ran) -> cost
Costs = Mapping[float, Mapping[Any, float]]


@dataclass(frozen=True)
class Crossover:
    """Where the costs of two methods, a and b, cross for the last time as x grows.

    Parameters
    ----------
    at : x of the crossing; None where the costs do not cross between the smallest and the largest x
    ahead : the method that costs less from there on, or everywhere: "a" or "b"
    """

    at: Summary | None
    ahead: str


def crossover(a: Costs, b: Costs) -> Crossover | None:
    """The crossover of two methods measured at the same x.

    Parameters
    ----------
    a, b : positive costs by x and repeat; repeats are paired

    Returns
    -------
    Crossover or None
        None where the two share fewer than two x. Costs are interpolated linearly between logarithms. Each repeat has
        a crossing of its own, and their median and interval are given; a repeat without one counts as crossing at the
        nearer end.

    Examples
    --------
    A cost that grows with the square of x, and one that grows with x but is 30 times as high at 1:

    >>> xs = (10.0, 20.0, 40.0, 80.0)
    >>> found = crossover({x: {0: x**2} for x in xs}, {x: {0: 30 * x} for x in xs})
    >>> f"from {found.at.median:.1f} on {found.ahead} costs less"
    'from 30.0 on b costs less'
    """
    xs = sorted(x for x in a.keys() & b.keys() if x > 0 and a[x].keys() & b[x].keys())
    repeats = sorted(set.intersection(*(set(a[x].keys() & b[x].keys()) for x in xs))) if len(xs) > 1 else []
    if not repeats:
        return None
    gaps = np.array([[math.log(b[x][repeat] / a[x][repeat]) for x in xs] for repeat in repeats])
    middle = np.median(gaps, axis=0)
    ahead = "b" if middle[-1] < 0 else "a"
    if (np.sign(middle) == np.sign(middle[-1])).all():
        return Crossover(None, ahead)
    sign = 1.0 if ahead == "a" else -1.0
    return Crossover(summary([_last_crossing(xs, sign * gap) for gap in gaps]), ahead)


def _last_crossing(xs: list[float], gap: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    """Where the gap turns positive for good."""
    behind = np.flatnonzero(gap <= 0)
    if not len(behind):
        return xs[0]
    k = int(behind[-1])
    if k == len(xs) - 1:
        return xs[-1]
    share = gap[k] / (gap[k] - gap[k + 1])
    return float(xs[k] * (xs[k + 1] / xs[k]) ** share)
