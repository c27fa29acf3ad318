"""Grids of cells: one for each size class of the spheres.

A cell is at least as wide as the diameter of the largest sphere of its class.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.motion.predictive.memory import filled
from harness.motion.predictive.order import REORDERED_FROM
from harness.motion.predictive.state import ANCHOR, GRID, LARGER, Cells, Records

# Radii of one class are within this ratio, and classes are joined where not more than so many spheres of both are in 27
# cells.
CLASS_RATIO, MOST_AROUND = 3.0, 60.0
# Cells of a grid for each of its spheres, at most. Eight still are as fast as fewer at packing .01, while all is in the
# cache. Of many small spheres between large ones, four: with 10^4 the rate is 1.05 to
# 1.2 times that with two, and six are no better.
CELLS_PER_SPHERE, MIXED_CELLS_PER_SPHERE = 8, 4
# Where there are no more of them than this for each sphere, the cells around the larger ones are kept.
REGISTERED_PER_SPHERE = 16
# Cells are wider than they must be by this fraction, so that rounding at a crossing cannot lose a neighbour.
SLACK = 1e-6


def empty_grids(half_box: Floats, radii: Floats, skin: float) -> Cells:
    """Empty grids for these spheres.

    Parameters
    ----------
    half_box : (3,) m
    radii : (n,) m, by internal number
    skin : how much wider than a diameter the cells must be, m (for neighbour lists)
    """
    classes = size_classes(radii, half_box)
    grids = np.zeros(int(classes.max(initial=0)) + 1, dtype=GRID)
    largest = np.array([radii[classes == level].max(initial=0.0) for level in range(len(grids))])
    width = 0.0
    for level in reversed(range(len(grids))):
        # as many cells as suit the larger spheres too, so that only few of these are near each of them
        no_smaller = np.count_nonzero(classes <= level)
        many_of_several = len(grids) > 1 and no_smaller >= REORDERED_FROM
        most = (MIXED_CELLS_PER_SPHERE if many_of_several else CELLS_PER_SPHERE) * no_smaller + 27
        least = np.full(3, 2.0 * largest[level] + skin)
        shape = cell_counts(half_box, least * (1.0 + SLACK) + 1e-14 * half_box.max(), most)
        finer = largest[level + 1] if level + 1 < len(grids) else 0.0
        margin = max(0.1 * largest[level], 0.5 * finer, 0.5 * width)
        grids[level] = shape, 0, -half_box, 2.0 * half_box / shape, largest[level], margin
        width = float(grids[level]["side"].min())
    sizes = grids["shape"].prod(axis=1)
    grids["first"] = np.concatenate(([0], np.cumsum(sizes)[:-1]))
    count = len(radii)
    anchors, room = empty_anchors(grids, radii, classes)
    return Cells(
        heads=filled(int(sizes.sum()), count, np.uint32),
        following=filled(count + 1, count, np.uint32),
        grids=grids,
        larger=np.zeros(int(sizes.sum()) if len(grids) > 1 else 0, dtype=LARGER),
        anchors=anchors,
        registered_at=np.zeros(room, dtype=np.uint32),
        renewals=np.full(count, np.inf),
    )


def empty_anchors(grids: Records, radii: Floats, classes: NDArray[np.int32]) -> tuple[Records, int]:
    """Anchors of spheres that are not registered yet, and the room for the cells at which they will be."""
    anchors = np.zeros(len(radii) if len(grids) > 1 else 0, dtype=ANCHOR)
    cells = np.zeros(len(anchors), dtype=np.int64)
    for own in range(len(grids) - 1):
        members = np.flatnonzero(classes == own)
        for grid in grids[own + 1 :]:
            reach = radii[members] + grid["largest"] + grids[own]["margin"]
            along = np.minimum(2.0 * reach[:, None] / grid["side"] + 2.0, grid["shape"])
            cells[members] += along.astype(np.int64).prod(axis=1)
    total = int(cells.sum())
    if total > REGISTERED_PER_SPHERE * len(radii):
        anchors["first"] = -1
        return anchors, 0
    anchors["first"] = np.cumsum(cells) - cells
    return anchors, total


def size_classes(radii: Floats, half_box: Floats) -> NDArray[np.int32]:
    """(n,) class of each sphere, 0 the largest. Spheres share a class as far as few enough are around each of them."""
    classes = ratio_classes(radii)
    merged = np.zeros(int(classes.max(initial=0)) + 1, dtype=np.int32)
    count, largest = 0, 0.0
    for level in range(len(merged)):
        members = radii[classes == level]
        count, largest = count + len(members), max(largest, float(members.max(initial=0.0)))
        around = 27.0 * count * (2.0 * largest) ** 3 / (8.0 * half_box.prod())
        merged[level] = merged[max(level - 1, 0)]
        if level > 0 and around > MOST_AROUND:
            merged[level] += 1
            count, largest = len(members), float(members.max(initial=0.0))
    joined: NDArray[np.int32] = merged[classes]
    return joined


def ratio_classes(radii: Floats) -> NDArray[np.int32]:
    """(n,) class of each sphere by size alone, 0 the largest; classes without a sphere are left out."""
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
