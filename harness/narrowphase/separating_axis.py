"""A direction along which two hulls are apart proves that they do not touch, and often goes on proving it frame after
frame: two support queries, where a search takes a dozen."""

from __future__ import annotations

from math import sqrt

import numpy as np

from harness.kernel import strict_step
from harness.narrowphase.support import SupportMap, support
from harness.narrowphase.vectors import Matrix, Vector, dot, turned_back


@strict_step
def gap_along(
    hull_a: SupportMap,
    hull_b: SupportMap,
    axis: Vector,
    rotation_a: Matrix,
    size_a: float,
    rotation_b: Matrix,
    size_b: float,
    offset: Vector,
) -> float:
    """How far the hull of body a is beyond that of b along an axis: a lower bound on their distance.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    axis : in the world, from b to a, of any length; zero proves nothing
    rotation_a, rotation_b : from the axes of the bodies to those of the world
    size_a, size_b : factors on the hull's vertices
    offset : from a's centre to b's, in the world

    Returns
    -------
    float
        Below 0 if the axis proves nothing. Its rounding error is below a tenth of `gjk.MARGIN` x (size_a + size_b) for
        bodies whose bounding spheres touch.
    """
    squared = dot(axis, axis)
    if not squared > 0.0:
        return -np.inf
    seen_by_a, seen_by_b = turned_back(rotation_a, axis), turned_back(rotation_b, axis)
    a = support(hull_a, -seen_by_a[0], -seen_by_a[1], -seen_by_a[2])
    b = support(hull_b, seen_by_b[0], seen_by_b[1], seen_by_b[2])
    vertex_a = hull_a.vertices[a, 0], hull_a.vertices[a, 1], hull_a.vertices[a, 2]
    vertex_b = hull_b.vertices[b, 0], hull_b.vertices[b, 1], hull_b.vertices[b, 2]
    gap = size_a * dot(seen_by_a, vertex_a) - size_b * dot(seen_by_b, vertex_b) - dot(axis, offset)
    return gap / sqrt(squared)
