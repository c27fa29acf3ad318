"""Where a series changed for good: steps of its level, found by PELT and kept where they stand out of the noise.

The candidates are those of the pruned exact linear time algorithm (Killick, Fearnhead and Eckley 2012) with the cost of
squared distances and the penalty 3 log n, in units of the noise. Each is then judged by Student's test of the values
before it against those after it, up to the next candidates. The noise is that of the series, moderated by that of all
series together (Smyth 2004), since a few values tell little of their own; the p-value is multiplied by the number of
places where a step could have been found.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import special

# How many degrees of freedom the noise of all series counts for.
_SHARED = 4.0
# Relative. Noise is never taken for less than this: five equal numbers do not say that the sixth will be.
_LEAST = 0.005
# From so many series on their common noise is known.
_FEWEST_SERIES = 5


@dataclass(frozen=True)
class Candidate:
    """A place where the level of a series may have changed.

    Parameters
    ----------
    place : of the first value of the new level
    change : of the mean, by how much the new level is higher
    p_value : of no change beyond the floor
    """

    place: int
    change: float
    p_value: float


def common_noise(series: Sequence[Sequence[float]]) -> float | None:
    """The standard deviation of a value of all series together, from differences of neighbours; None where few tell."""
    found = [_noise(np.asarray(values, dtype=float)) for values in series if len(values) > 2]
    return math.sqrt(float(np.mean(np.square(found)))) if len(found) >= _FEWEST_SERIES else None


def candidates(values: Sequence[float], common: float | None, floor: float) -> list[Candidate]:
    """The places where a series may have changed, each with its p-value.

    Parameters
    ----------
    values : in the order of time, on a scale on which noise is the same everywhere, such as logarithms of times
    common : `common_noise` of all series that are looked at
    floor : a change must be larger than this to be one

    Examples
    --------
    >>> [step] = candidates([1.0, 1.01, 1.0, 0.99, 1.5, 1.51, 1.5], 0.01, 0.1)
    >>> step.place, round(step.change, 2), step.p_value < 0.001
    (4, 0.5, True)
    """
    signal = np.asarray(values, dtype=float)
    n = len(signal)
    if n < 4:
        return []
    from ruptures import Pelt  # a second of imports, which few reports have series long enough for

    own = max(_noise(signal), _LEAST)
    unit = own if common is None else max(common, _LEAST)
    search = Pelt(model="l2", min_size=2, jump=1).fit(signal / min(own, unit))
    *places, _ = search.predict(pen=3.0 * math.log(n))
    bounds = [0, *(int(place) for place in places), n]
    parts = [signal[start:end] for start, end in pairwise(bounds)]
    degrees = float(n - len(parts))
    variance = sum(float(((part - part.mean()) ** 2).sum()) for part in parts)
    if common is not None:
        variance, degrees = variance + _SHARED * common**2, degrees + _SHARED
    if degrees <= 0.0:
        return []
    spread = max(math.sqrt(variance / degrees), _LEAST)
    found = []
    for place, before, after in zip(bounds[1:-1], parts, parts[1:], strict=False):
        change = float(after.mean() - before.mean())
        error = spread * math.sqrt(1.0 / len(before) + 1.0 / len(after))
        beyond = abs(change) - floor
        p_value = 1.0 if beyond <= 0.0 else min(1.0, 2.0 * (n - 1) * float(special.stdtr(degrees, -beyond / error)))
        found.append(Candidate(place, change, p_value))
    return found


def _noise(values: NDArray[np.float64]) -> float:
    """The standard deviation of a value by the median difference of neighbours, which few steps do not move."""
    return float(np.median(np.abs(np.diff(values)))) / (0.6745 * math.sqrt(2.0))
