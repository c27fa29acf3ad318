"""Distance of two convex hulls, and whether they touch: the algorithm of Gilbert, Johnson and Keerthi (1988).

It walks through the Minkowski difference a - b of the hulls towards the origin. Every step yields a point of the
difference, so an upper bound on the distance, and a plane that bounds it from below; what is returned is certified by
one of the two, whatever rounding did on the way. Lengths are in any one unit; all vectors are in the frame of hull a.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.simplex import (
    ALL_CORNERS,
    Nearest,
    Simplex,
    depth_of_origin,
    extended,
    kept,
    nearest_on,
    nearest_on_segment,
    nearest_on_tetrahedron,
    nearest_on_triangle,
    weights,
)
from harness.narrowphase.support import SupportMap, support
from harness.narrowphase.vectors import Matrix, Vector, dot, minus, plus, scaled, turned, turned_back, turned_by_both
from harness.narrowphase.verdicts import PairVerdict

# Of the sum of the sizes: the gap or the overlap that a certificate must show. Turning and placing two vertices of
# close bodies rounds by less than a tenth of it.
MARGIN = 1e-13
# Of the sum of the sizes: the gap down to which searches for an impact come; nearer, the axis of the gap is rounding.
LEAST_GAP = 5.0 * MARGIN

# Relative distance between the two bounds at which the walk ends; it mostly ends earlier, at a vertex seen before.
PRECISION = 1e-14
MOST_STEPS = 100

WarmStart = tuple[int, int, int, int]
"""The simplex that the last search of a pair ended with: of each corner vertex a << 32 | vertex b, and -1 for none."""

COLD_START: WarmStart = (-1, -1, -1, -1)


class Relative(NamedTuple):
    """Hull b as seen from hull a.

    Attributes
    ----------
    rotation : of b's axes
    offset : from a's centre to b's
    size_a, size_b : factors on the hull's vertices
    """

    rotation: Matrix
    offset: Vector
    size_a: float
    size_b: float


class HullDistance(NamedTuple):
    """What is known of two hulls.

    Attributes
    ----------
    verdict : SEPARATE or TOUCHING if certified, else UNDECIDED: closer to touching than rounding can tell
    lower, upper : bounds on the distance; 0 where they overlap
    axis : along which they are at least `lower` apart, pointing from b to a; of no certain length
    point_a, point_b : points of the hulls that are `upper` apart; of no meaning where they overlap
    warm_start : for the next search of this pair
    """

    verdict: PairVerdict
    lower: float
    upper: float
    axis: Vector
    point_a: Vector
    point_b: Vector
    warm_start: WarmStart


@kernel
def relative_pose(rotation_a: Matrix, size_a: float, rotation_b: Matrix, size_b: float, offset: Vector) -> Relative:
    """Hull b as seen from hull a; the rotations and the offset from a's centre to b's are those in the world."""
    return Relative(turned_by_both(rotation_a, rotation_b), turned_back(rotation_a, offset), size_a, size_b)


@kernel
def hull_distance(
    hull_a: SupportMap,
    hull_b: SupportMap,
    pose: Relative,
    start: WarmStart,
    axis: Vector,
    margin: float,
    enough: float,
    tolerance: float,
) -> HullDistance:
    """Distance of two hulls.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    pose : Relative
    start : that of an earlier answer for this pair, or COLD_START. It only saves time.
    axis : for a cold start, the first guess at the direction from b to a; not zero unless the centres coincide
    margin : gap or overlap that a certificate must show, at least MARGIN x (size_a + size_b)
    enough : a gap that need not be known better; `margin` to know only whether they touch
    tolerance : by how much the two bounds may differ

    Returns
    -------
    HullDistance
        With `upper` - `lower` within the tolerance, or rounding of 1e-14 of the distance, unless `lower` is above
        `enough`.
    """
    s0, s1, s2, s3 = start
    if s0 < 0:
        if not (axis[0] != 0.0 or axis[1] != 0.0 or axis[2] != 0.0):
            axis = (1.0, 0.0, 0.0)
        s0 = farthest(hull_a, hull_b, pose, scaled(axis, -1.0))
    p0 = difference(hull_a, hull_b, pose, s0)
    p1 = p2 = p3 = p0
    nearest = Nearest(p0, dot(p0, p0), 1)
    if s1 >= 0:
        p1 = difference(hull_a, hull_b, pose, s1)
        nearest = nearest_on_segment(p0, p1)
    if s2 >= 0:
        p2 = difference(hull_a, hull_b, pose, s2)
        nearest = nearest_on_triangle(p0, p1, p2)
    simplex = Simplex(p0, p1, p2, p3, (s0, s1, s2, s3), 4)
    if s3 >= 0:
        p3 = difference(hull_a, hull_b, pose, s3)
        simplex = Simplex(p0, p1, p2, p3, (s0, s1, s2, s3), 4)
        if depth_of_origin(p0, p1, p2, p3) > margin:
            return HullDistance(PairVerdict.TOUCHING, 0.0, 0.0, nearest.point, p0, p0, simplex.vertices)
        other = nearest_on_tetrahedron(p0, p1, p2, p3)
        if other.corners != ALL_CORNERS and other.squared < nearest.squared:
            nearest = other

    simplex = kept(simplex, nearest.corners)
    lower, best = 0.0, nearest.point
    for _ in range(MOST_STEPS):
        squared = nearest.squared
        if squared <= margin * margin:
            break
        vertex = farthest(hull_a, hull_b, pose, scaled(nearest.point, -1.0))
        point = difference(hull_a, hull_b, pose, vertex)
        along = dot(nearest.point, point)
        if along > 0.0 and along > lower * sqrt(squared):
            lower, best = along / sqrt(squared), nearest.point
            if lower > enough:
                break
        if squared - along <= max(PRECISION * squared, tolerance * sqrt(squared)) or vertex in simplex.vertices:
            break
        larger = extended(simplex, point, vertex)
        step = nearest_on(larger)
        if step.corners == ALL_CORNERS:
            inside = depth_of_origin(larger.a, larger.b, larger.c, larger.d) > margin
            verdict = PairVerdict.TOUCHING if inside else PairVerdict.UNDECIDED
            return HullDistance(verdict, 0.0, 0.0, nearest.point, larger.a, larger.a, larger.vertices)
        if not step.squared < squared:  # rounding ends the descent
            break
        simplex, nearest = kept(larger, step.corners), step
    verdict = PairVerdict.SEPARATE if lower > margin else PairVerdict.UNDECIDED
    shares = weights(simplex.a, simplex.b, simplex.c, simplex.size)
    point_a = point_b = (0.0, 0.0, 0.0)
    for corner in range(simplex.size):
        vertices, share = simplex.vertices[corner], shares[corner]
        point_a = plus(point_a, scaled(vertex_a(hull_a, pose, vertices >> 32), share))
        point_b = plus(point_b, scaled(vertex_b(hull_b, pose, vertices & 0xFFFFFFFF), share))
    upper = max(lower, sqrt(nearest.squared))
    return HullDistance(verdict, lower, upper, best, point_a, point_b, simplex.vertices)


@strict_step
def farthest(hull_a: SupportMap, hull_b: SupportMap, pose: Relative, along: Vector) -> int:
    """The vertices, a << 32 | b, whose difference a - b reaches farthest along a direction that is not zero."""
    back = turned_back(pose.rotation, along)
    a = support(hull_a, along[0], along[1], along[2])
    b = support(hull_b, -back[0], -back[1], -back[2])
    return int(np.int64(a) << 32 | np.int64(b))


@strict_step
def difference(hull_a: SupportMap, hull_b: SupportMap, pose: Relative, vertices: int) -> Vector:
    """The point a - b of the Minkowski difference, of vertices a << 32 | b."""
    return minus(vertex_a(hull_a, pose, vertices >> 32), vertex_b(hull_b, pose, vertices & 0xFFFFFFFF))


@strict_step
def vertex_a(hull: SupportMap, pose: Relative, vertex: int) -> Vector:
    place = hull.vertices[vertex, 0], hull.vertices[vertex, 1], hull.vertices[vertex, 2]
    return scaled(place, pose.size_a)


@strict_step
def vertex_b(hull: SupportMap, pose: Relative, vertex: int) -> Vector:
    place = hull.vertices[vertex, 0], hull.vertices[vertex, 1], hull.vertices[vertex, 2]
    return plus(pose.offset, scaled(turned(pose.rotation, place), pose.size_b))
