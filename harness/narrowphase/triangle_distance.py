"""Distance of two triangles, certified from both sides.

The walk of Gilbert, Johnson and Keerthi (1988) through the differences of the corners needs no cases for edges and
faces, and none for triangles that are needles or points. It ends at a pair of points, an upper bound, and at an axis
along which the corners themselves show the lower bound.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from harness.kernel import kernel
from harness.narrowphase.simplex import (
    Nearest,
    nearest_on_segment,
    nearest_on_tetrahedron,
    nearest_on_triangle,
    room_around_origin,
)
from harness.narrowphase.vectors import Vector, dot, minus, plus, scaled

Triangle = tuple[Vector, Vector, Vector]

# Relative distance between the two bounds at which the walk ends; it mostly ends earlier, at corners seen before.
PRECISION = 1e-14
MOST_STEPS = 30


class TriangleDistance(NamedTuple):
    """What is known of two triangles.

    Attributes
    ----------
    lower, upper : bounds on the distance; 0 where they cross, or where rounding cannot tell
    axis : unit vector pointing from the second triangle to the first, which are `lower` apart along it
    """

    lower: float
    upper: float
    axis: Vector


@kernel
def triangle_distance(one: Triangle, other: Triangle, margin: float) -> TriangleDistance:
    """Distance of two triangles, in any one unit.

    Parameters
    ----------
    one, other : Triangle
    margin : a distance that need not be told from 0

    Returns
    -------
    TriangleDistance
        With `upper` - `lower` within rounding of 1e-14 of the distance, unless the walk ended at the margin.
    """
    middle_one, middle_other = plus(plus(one[0], one[1]), one[2]), plus(plus(other[0], other[1]), other[2])
    p0, s0, _ = lowest(one, other, minus(middle_one, middle_other))
    p1, p2, p3, s1, s2, s3 = p0, p0, p0, -1, -1, -1
    nearest, squared, corners = p0, dot(p0, p0), 1
    lower, axis = 0.0, nearest
    for _ in range(MOST_STEPS):
        # drop the corners that do not carry the nearest point, from the last on
        count = 4
        if not corners & 8:
            s3, count = -1, 3
        if not corners & 4:
            p2, s2, s3 = p3, s3, -1
            count -= 1
        if not corners & 2:
            p1, s1, p2, s2, s3 = p2, s2, p3, s3, -1
            count -= 1
        if not corners & 1:
            p0, s0, p1, s1, p2, s2, s3 = p1, s1, p2, s2, p3, s3, -1
            count -= 1
        if squared <= margin * margin:
            return TriangleDistance(0.0, sqrt(squared), unit(axis))
        point, corner, along = lowest(one, other, nearest)
        if along > 0.0 and along > lower * sqrt(squared):
            lower, axis = along / sqrt(squared), nearest
        if squared - along <= PRECISION * squared or corner in (s0, s1, s2):
            break
        if count == 1:
            p1, s1 = point, corner
            step = nearest_on_segment(p0, p1)
        elif count == 2:
            p2, s2 = point, corner
            step = nearest_on_triangle(p0, p1, p2)
        else:
            p3, s3 = point, corner
            step = nearest_on_tetrahedron(p0, p1, p2, p3)
            if step[2] == 15:
                if room_around_origin(p0, p1, p2, p3) > 0.0:
                    return TriangleDistance(0.0, 0.0, unit(axis))
                step = nearest_on_flat(p0, p1, p2, p3)
        if not step[1] < squared:  # rounding ends the descent
            break
        nearest, squared, corners = step
    return TriangleDistance(lower, max(lower, sqrt(squared)), unit(axis))


@kernel
def nearest_on_flat(a: Vector, b: Vector, c: Vector, d: Vector) -> Nearest:
    """The point nearest to the origin on the faces at d of a tetrahedron too flat to tell its sides: parallel edges."""
    point, squared, corners = nearest_on_triangle(a, b, d)
    best = point, squared, corners & 3 | (corners & 4) << 1
    point, squared, corners = nearest_on_triangle(b, c, d)
    if squared < best[1]:
        best = point, squared, corners << 1
    point, squared, corners = nearest_on_triangle(a, c, d)
    if squared < best[1]:
        best = point, squared, corners & 1 | (corners & 6) << 1
    return best


@kernel
def lowest(one: Triangle, other: Triangle, axis: Vector) -> tuple[Vector, int, float]:
    """The difference of two corners that is lowest along an axis, its number, and how high it is."""
    a, i, height_a = one[0], 0, dot(axis, one[0])
    for corner in range(1, 3):
        height = dot(axis, one[corner])
        if height < height_a:
            a, i, height_a = one[corner], corner, height
    b, j, height_b = other[0], 0, dot(axis, other[0])
    for corner in range(1, 3):
        height = dot(axis, other[corner])
        if height > height_b:
            b, j, height_b = other[corner], corner, height
    return minus(a, b), 3 * i + j, height_a - height_b


@kernel
def unit(axis: Vector) -> Vector:
    """Of length 1, or zero."""
    length = sqrt(dot(axis, axis))
    return scaled(axis, 1.0 / length) if length > 0.0 else axis
