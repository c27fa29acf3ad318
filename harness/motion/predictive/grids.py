"""Grids of cells: one for each size class of the spheres.

A cell is about as wide as the diameter of the largest sphere of its class. A cell of a coarser grid is at least the two
radii, the finer cell and two margins wide: see `harness.motion.predictive.cells`.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from harness.motion.predictive.order import REORDERED_FROM
from harness.motion.predictive.state import GRID, Cells, Floats

# Radii of one class are within this ratio.
CLASS_RATIO = 3.0
# Cells of a grid for each of its spheres, at most. Eight still are as fast as fewer at packing .01, while all is in the
# cache. Of many small spheres between large ones, two: they cross less often, and the large ones are asked about anew
# after each crossing; with 10^4 the rate is 1.2 times as high.
CELLS_PER_SPHERE, MIXED_CELLS_PER_SPHERE = 8, 2
# Cells are wider than they must be by this fraction, so that rounding at a crossing cannot lose a neighbour.
SLACK = 1e-6


def empty_grids(half_box: Floats, radii: Floats, skin: float) -> Cells:
    """Empty grids for these spheres.

    Parameters
    ----------
    half_box : (3,) m
    radii : (n,) m
    skin : how much wider than a diameter the cells must be, m (for neighbour lists)
    """
    classes = size_classes(radii)
    grids = np.zeros(int(classes.max(initial=0)) + 1, dtype=GRID)
    needed = np.zeros(3)
    finer = 0.0
    width = np.inf  # of the narrowest cell of a finer grid
    for level in reversed(range(len(grids))):
        members = radii[classes == level]
        largest = float(members.max(initial=0.0))
        # few small spheres stand in wide cells: a margin of their own size would be flown through again and again
        margin = max(0.1 * largest, 0.5 * finer, 0.25 * width) if finer else 0.0
        least = np.maximum(2.0 * largest + skin, needed + largest + 2.0 * margin if finer else 0.0)
        many_of_several = len(grids) > 1 and len(members) >= REORDERED_FROM
        most = (MIXED_CELLS_PER_SPHERE if many_of_several else CELLS_PER_SPHERE) * len(members) + 27
        shape = cell_counts(half_box, least * (1.0 + SLACK) + 1e-14 * half_box.max(), most)
        side = 2.0 * half_box / shape
        grids[level] = shape, 0, -half_box, side, largest, margin
        finer, width = max(finer, largest), min(width, float(side.min()))
        needed = np.maximum(needed, side + largest)
    sizes = grids["shape"].prod(axis=1)
    grids["first"] = np.concatenate(([0], np.cumsum(sizes)[:-1]))
    count = len(radii)
    return Cells(
        heads=np.full(int(sizes.sum()), count, dtype=np.uint32),
        following=np.full(count + 1, count, dtype=np.uint32),
        grids=grids,
        renewals=np.full(count, np.inf),
    )


def size_classes(radii: Floats) -> NDArray[np.int32]:
    """(n,) class of each sphere, 0 the largest; classes without a sphere are left out."""
    classes = np.zeros(len(radii), dtype=np.int32)
    rest = radii
    while len(rest := rest[rest * CLASS_RATIO < rest.max(initial=0.0)]):
        classes[radii <= rest.max()] += 1
    return classes


def cell_counts(half_box: Floats, least: Floats, most: int) -> NDArray[np.int64]:
    """(3,) cells along each axis, none smaller than `least` (3,) unless alone on its axis, `most` in all."""

    def counts(growth: float) -> NDArray[np.int64]:
        return np.maximum(np.minimum(2.0 * half_box / (least * growth), 1e9).astype(np.int64), 1)

    low, high = 1.0, 1.0
    while counts(high).astype(float).prod() > most:
        low, high = high, 2.0 * high
    for _ in range(40 if high > 1.0 else 0):
        middle = sqrt(low * high)
        low, high = (middle, high) if counts(middle).astype(float).prod() > most else (low, middle)
    return counts(high)
