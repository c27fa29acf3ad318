"""Whether two medians can be told apart: by their paired repeats, and by a control that was run twice.

An interval of five repeats leaves out the true median in one case of sixteen, so that of two equal methods one would
win that often. A control, the same point run as two arms, shows what such a win is worth. A difference is told apart
from none where all of this holds:

- there are five pairs of repeats or more, and a control of five pairs or more;
- the interval of the ratio lies beyond the noise floor, which is the typical distance of a control's two arms;
- its p-value is at most the level that the whole report allows (see `level`).

The p-value is the larger of two, so that it holds whenever one of them does: that of Student's paired test on
logarithms, and that of a sign test against the control, which asks nothing of the noise but that two equal points come
apart as the two arms of the control do.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.measure.statistics import FEWEST_FOR_INTERVAL, Summary, interval_place

FALSE_RATE = 0.05
"""How many of the differences that a report calls one may be none: the rate of false discoveries."""


Place = tuple[str, int, str]
"""Point, repeat and machine of a run."""


@dataclass(frozen=True)
class Control:
    """How far equal runs came apart: |log(first / second)| of every pair, in order."""

    distances: tuple[float, ...]

    @property
    def floor(self) -> float:
        """The noise floor, relative: how far from 1 the ratio of two equal runs typically is."""
        return math.exp(float(np.median(self.distances))) - 1.0


def control(first: Sequence[float], second: Sequence[float]) -> Control | None:
    """What the two arms of a control tell.

    Parameters
    ----------
    first, second : the arms, paired by their place; pairs that are not both above 0 do not count

    Returns
    -------
    Control or None
        None below five pairs, which say too little.
    """
    pairs = [(a, b) for a, b in zip(first, second, strict=True) if a > 0.0 and b > 0.0]
    if len(pairs) < FEWEST_FOR_INTERVAL:
        return None
    return Control(tuple(sorted(abs(math.log(a / b)) for a, b in pairs)))


def controls_of(
    runs: Mapping[Place, Mapping[str, float]], again: Iterable[tuple[Place, Mapping[str, float]]]
) -> dict[str, Control]:
    """The control of every clock that tells one.

    Parameters
    ----------
    runs : metrics by point, repeat and machine
    again : the same runs done once more, each with the clocks that it read
    """
    arms: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for place, clocks in again:
        first = runs.get(place, {})
        for metric, value in clocks.items():
            if metric in first:
                arms[metric].append((first[metric], value))
    known = {metric: control(*zip(*found, strict=True)) for metric, found in arms.items()}
    return {metric: found for metric, found in known.items() if found is not None}


def noise_floor(first: Sequence[float], second: Sequence[float]) -> float | None:
    """How far from 1, relatively, the ratio of two equal runs typically is: the median over the pairs of a control.

    Examples
    --------
    >>> f"{noise_floor([1.0, 1.0, 1.0, 1.0, 1.0], [1.00, 1.02, 0.98, 1.03, 1.01]):.2f}"
    '0.02'
    """
    found = control(first, second)
    return None if found is None else found.floor


def distinguishable(ratio: Summary, floor: float) -> bool:
    """Whether a ratio is not 1: its whole interval lies beyond the noise floor, on one side.

    >>> slower = Summary(1.08, 1.05, 1.12, 0.9375, 5)
    >>> distinguishable(slower, floor=0.02), distinguishable(slower, floor=0.06)
    (True, False)
    """
    return ratio.low > 1.0 + floor or ratio.high * (1.0 + floor) < 1.0


def p_value(ratios: ArrayLike, known: Control) -> float:
    """How often two equal points would come as far apart as these, at most.

    Parameters
    ----------
    ratios : of paired repeats, five or more, each above 0
    known : the control of the same clock

    Examples
    --------
    Five pairs on one side, all farther out than all five of the control, are so once in 4032 times:

    >>> quiet = Control((0.001, 0.002, 0.003, 0.004, 0.005))
    >>> f"{p_value([1.30, 1.31, 1.32, 1.31, 1.30], quiet) * 4032:.3f}"
    '1.000'
    """
    logs = np.log(np.asarray(ratios, dtype=float))
    return max(student(logs), sign_test(np.sort(logs), known))


def student(logs: ArrayLike, floor: float = 0.0) -> float:
    """The p-value of Student's test that the mean of logarithms of ratios lies no farther from 0 than a floor.

    Parameters
    ----------
    logs : logarithms of paired ratios
    floor : of |log ratio|

    >>> f"{student([0.1, 0.2, 0.3, 0.1, 0.2]):.4f}", student([0.1, 0.1, 0.1]), student([0.0, 0.0])
    ('0.0086', 0.0, 1.0)
    """
    values = np.asarray(logs, dtype=float)
    n = len(values)
    if n < 2:
        return 1.0
    beyond = abs(float(values.mean())) - floor
    error = float(values.std(ddof=1)) / math.sqrt(n)
    if beyond <= 0.0:
        return 1.0
    # a spread of rounding alone is none
    if error <= 1e-14 * beyond:
        return 0.0
    from scipy import special  # as in `harness.measure.statistics`

    return float(2.0 * special.stdtr(n - 1, -beyond / error))


def level(p_values: Sequence[float], rate: float = FALSE_RATE) -> float:
    """The largest p-value that counts, when all of these are looked at: Benjamini and Hochberg's.

    Of the differences called one, no more than `rate` are none on average; where nothing differs, all of them would be,
    so that a report in which nothing differs names none with probability 1 - rate.

    >>> level([0.2, 0.04, 0.001]), level([0.2, 0.04, 0.03]), level([])
    (0.001, 0.0, 0.05)
    """
    values = np.sort(np.asarray(p_values, dtype=float))
    if not len(values):
        return rate
    adjusted = values * (len(values) / np.arange(1, len(values) + 1))
    counted = values[np.minimum.accumulate(adjusted[::-1])[::-1] <= rate]
    return float(counted[-1]) if len(counted) else 0.0


def sign_test(logs: NDArray[np.float64], known: Control) -> float:
    """How often, of equal points, the end of the interval would lie beyond as many of the control's distances.

    Parameters
    ----------
    logs : logarithms of paired ratios, five or more, in order
    """
    n = len(logs)
    place, _ = interval_place(n)
    nearest = max(float(logs[place]), -float(logs[n - 1 - place]))
    if nearest <= 0.0:
        return 1.0
    return _chance(n, place, len(known.distances), bisect_left(known.distances, nearest))


@lru_cache(maxsize=4096)
def _chance(n: int, place: int, controls: int, beyond: int) -> float:
    """How often, of n equal pairs, all but `place` lie on one side, farther out than `beyond` pairs of a control.

    The distances of equal pairs and control come in any order, with the same probability; either sign of each is as
    likely.
    """
    from scipy import special

    # of the pairs, so many lie no farther out than those of the control
    chances = [(nearer, _comes_before(nearer, beyond, n, controls)) for nearer in range(place + 1)]
    both = sum(chance * float(special.bdtrc(n - place - 1, n - nearer, 0.5)) for nearer, chance in chances)
    return min(1.0, 2.0 * both)


def _comes_before(nearer: int, beyond: int, n: int, controls: int) -> float:
    """How often, of n equal pairs and so many of a control in any order, so many come before `beyond` of the control.

    The negative hypergeometric distribution.
    """
    if not beyond:
        return float(nearer == 0)
    orders = math.comb(nearer + beyond - 1, nearer) * math.comb(n + controls - beyond - nearer, n - nearer)
    return orders / math.comb(n + controls, n)
