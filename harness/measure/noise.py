"""The noise floor: how far two equal runs come apart on a machine, below which two methods are not distinguishable.

An interval of five repeats leaves out the true median in one case of sixteen, so that of two equal methods one would
win that often. A control, the same point run as two arms, shows what such a win is worth: with its floor, an equal
method wins only if all its five ratios lie where a quarter of them belongs.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.measure.statistics import FEWEST_FOR_INTERVAL, Summary


def noise_floor(first: Sequence[float], second: Sequence[float]) -> float | None:
    """How far from 1, relatively, the ratio of two equal runs typically is: the median over the pairs of a control.

    Parameters
    ----------
    first, second : the arms, paired by their place; pairs that are not both above 0 do not count

    Returns
    -------
    float or None
        0.03 where equal runs come 3 % apart. None below five pairs, which say too little.
    """
    pairs = np.array([(a, b) for a, b in zip(first, second, strict=True) if a > 0.0 and b > 0.0]).reshape(-1, 2)
    if len(pairs) < FEWEST_FOR_INTERVAL:
        return None
    return float(np.median(pairs.max(axis=1) / pairs.min(axis=1))) - 1.0


def distinguishable(ratio: Summary, floor: float) -> bool:
    """Whether a ratio is not 1: its whole interval lies beyond the noise floor, on one side."""
    return ratio.low > 1.0 + floor or ratio.high * (1.0 + floor) < 1.0
