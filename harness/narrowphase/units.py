"""The length in which a library is told of a scene, so that bodies are about 1 across.

Libraries carry absolute tolerances: FCL misjudges hulls of 1e-4 m, Bullet those below 1e-3 or above 1e6 m. A power of
two changes no digit of a coordinate, so the verdicts are those of the scene as it is.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats

UNITS = "the median size is about 1, by a power of two"
"""What the backends that do so say of it."""

SMALLEST_UNITS = "the smallest size is about 1, by a power of two"
"""What a backend says whose library errs by an absolute length, which must be little of every body."""


def unit_of_smallest(sizes: Floats) -> float:
    """The power of two nearest to the smallest size, m; 1 without bodies.

    Parameters
    ----------
    sizes : (n,) float array, m
    """
    return float(2.0 ** np.round(np.log2(np.min(sizes)))) if len(sizes) else 1.0


def unit_of(sizes: Floats) -> float:
    """The power of two nearest to the median size, m; 1 without bodies.

    Parameters
    ----------
    sizes : (n,) float array, m
    """
    return float(2.0 ** np.round(np.log2(np.median(sizes)))) if len(sizes) else 1.0
