"""The noise floor: how far two equal things come apart on a machine, below which no two others are told apart.

An interval of five repeats leaves out the true median in one case of sixteen, so that of two equal methods one would
win that often. A control, the same point run as two arms, shows what such a win is worth.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.measure.statistics import FEWEST_FOR_INTERVAL, Summary, paired_ratio


def noise_floor(first: Sequence[float], second: Sequence[float]) -> float | None:
    """How far from 1, relatively, the interval of the ratio of two equal arms reaches.

    Parameters
    ----------
    first, second : the arms, paired by their place

    Returns
    -------
    float or None
        0.03 where equal things may seem 3 % apart. None below five pairs, which say too little.
    """
    ratio = paired_ratio(first, second)
    if ratio.n < FEWEST_FOR_INTERVAL or not 0.0 < ratio.low <= ratio.high < math.inf:
        return None
    return max(ratio.high, 1.0 / ratio.low) - 1.0


def told_apart(ratio: Summary, floor: float) -> bool:
    """Whether a ratio is not 1: its whole interval lies beyond the noise floor, on one side."""
    return ratio.low > 1.0 + floor or ratio.high * (1.0 + floor) < 1.0
