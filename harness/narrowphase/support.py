"""Support functions: the vertex of a hull that reaches farthest in a direction, found in a time that hardly grows.

Directions are sorted into cells of an octahedron unfolded to a square. Each cell lists the vertices that are farthest
for some direction in it, about two on average, so that a query looks up one cell and compares those few. Unlike
climbing along edges it needs no start, no edges, and no trust in a hull's convexity.
"""

from __future__ import annotations

from math import copysign, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.kernel import kernel, strict_step
from harness.narrowphase.vectors import Vector

# A vertex leaves a cell's list only if another reaches this much farther (in units of the diameter) in every direction
# of the cell; more than rounding does to a reach or to a direction on the border of two cells.
SLACK = 1e-12
# At least, of a hull of many vertices. With four times fewer a search for an impact takes 4 % longer; with four times
# more, 4 % less, but the map takes three times as long to make, and more room than a first cache has.
CELLS_PER_VERTEX = 8


class SupportMap(NamedTuple):
    """Vertices of a hull, and which of them can be the farthest in each cell of directions.

    Attributes
    ----------
    vertices : (h, 3) float array
    start : (cells + 1,) int32 array, where the list of each cell begins
    candidates : int32 array, the lists
    side : cells along each side of the square
    """

    vertices: Floats
    start: NDArray[np.int32]
    candidates: NDArray[np.int32]
    side: int


def support_map(vertices: Floats) -> SupportMap:
    """The map of a hull, with 8 to 32 cells a vertex.

    Parameters
    ----------
    vertices : (h, 3) float array
        Of diameter about 1; inner points do no harm.
    """
    vertices = np.array(vertices, np.float64, order="C")
    start, candidates = np.array([0, len(vertices)], np.int32), np.arange(len(vertices), dtype=np.int32)
    side = 1
    while side < 8 or side * side < CELLS_PER_VERTEX * len(vertices):
        side *= 2
        # the directions of a cell are among those of the cell it is a quarter of, and so are its vertices
        start, candidates = refine(vertices, start, candidates, side)
    return SupportMap(vertices, start, candidates, side)


@strict_step
def support(hull: SupportMap, x: float, y: float, z: float) -> int:
    """The vertex that reaches farthest along (x, y, z), which must be finite and not zero. Of others, any."""
    scale = 1.0 / (abs(x) + abs(y) + abs(z))
    u, v = x * scale, y * scale
    if z < 0.0:
        u, v = copysign(1.0 - abs(v), x), copysign(1.0 - abs(u), y)
    half, last = 0.5 * hull.side, hull.side - 1
    u, v = (u + 1.0) * half, (v + 1.0) * half
    u, v = u if u > 0.0 else 0.0, v if v > 0.0 else 0.0  # whatever is not a number must not become an index
    cell = min(int(u), last) * hull.side + min(int(v), last)
    best, farthest = hull.candidates[hull.start[cell]], -np.inf
    for k in range(hull.start[cell], hull.start[cell + 1]):
        vertex = hull.candidates[k]
        reach = x * hull.vertices[vertex, 0] + y * hull.vertices[vertex, 1] + z * hull.vertices[vertex, 2]
        if reach > farthest:
            best, farthest = vertex, reach
    return int(best)


@kernel
def refine(
    vertices: Floats, start: NDArray[np.int32], candidates: NDArray[np.int32], side: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The lists of side x side cells, given those of a quarter as many."""
    corners = np.empty((4, 3))
    capacity = 4 * len(candidates)
    new_start = np.zeros(side * side + 1, np.int32)
    kept = np.empty(capacity, np.int32)
    count = 0
    for cell in range(side * side):
        u, v = cell // side, cell % side
        for corner in range(4):
            corners[corner] = direction(2.0 * (u + corner // 2) / side - 1.0, 2.0 * (v + corner % 2) / side - 1.0)
        parent = (u // 2) * (side // 2) + v // 2
        listed = candidates[start[parent] : start[parent + 1]]
        count = keep_farthest(vertices, listed, corners, kept, count)
        new_start[cell + 1] = count
    return new_start, kept[:count].copy()


@kernel
def keep_farthest(
    vertices: Floats, listed: NDArray[np.int32], corners: Floats, kept: NDArray[np.int32], count: int
) -> int:
    """Append the listed vertices that no other listed one outreaches at all corners, thus in all directions between."""
    reach = np.zeros((len(listed), 4))
    centre, best = -np.inf, 0
    for k in range(len(listed)):
        total = 0.0
        for corner in range(4):
            for axis in range(3):
                reach[k, corner] += vertices[listed[k], axis] * corners[corner, axis]
            total += reach[k, corner]
        if total > centre:
            centre, best = total, k
    begin = count
    for k in range(len(listed)):
        if not outreached(reach[k], reach[best]):
            kept[count] = k
            count += 1
    if count - begin <= 64:  # among more, the pairwise search can wait for smaller cells
        survivors = kept[begin:count].copy()
        count = begin
        for k in survivors:
            dominated = False
            for other in survivors:
                dominated = dominated or outreached(reach[k], reach[other])
            if not dominated:
                kept[count] = k
                count += 1
    for k in range(begin, count):
        kept[k] = listed[kept[k]]
    return count


@kernel
def outreached(reach: Floats, other: Floats) -> bool:
    """Whether another vertex reaches farther at all four corners of a cell."""
    least = np.inf
    for corner in range(4):
        least = min(least, other[corner] - reach[corner])
    return least > SLACK


@kernel
def direction(u: float, v: float) -> Vector:
    """The unit direction at a point of the square, -1 <= u, v <= 1."""
    z = 1.0 - abs(u) - abs(v)
    x, y = u, v
    if z < 0.0:
        x, y = copysign(1.0 - abs(v), u), copysign(1.0 - abs(u), v)
    length = sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length
