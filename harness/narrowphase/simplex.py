"""The point of a segment, triangle or tetrahedron nearest to the origin, and which corners carry it.

Steps of the Gilbert-Johnson-Keerthi algorithm. Regions are told by the signs of triple products about the origin, and
a flat triangle or tetrahedron is replaced by its edges or faces, so that no division is by a vanishing area.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.vectors import Vector, cross, dot, minus, plus, scaled

# Of the product of the lengths: the most that rounding changes a triple product, and some more.
ROUNDING = 2e-15

# The corners that carry a point inside of a tetrahedron.
ALL_CORNERS = 15


class Nearest(NamedTuple):
    """The point of a simplex nearest to the origin.

    Attributes
    ----------
    point : it
    squared : its distance, squared
    corners : a bit for each corner that carries it; that of the first is 1
    """

    point: Vector
    squared: float
    corners: int


class Simplex(NamedTuple):
    """One to four corners, and which vertices they come from.

    Attributes
    ----------
    a, b, c, d : the corners; of no meaning from the size on
    vertices : a number for each; -1 from the size on
    size : how many corners there are
    """

    a: Vector
    b: Vector
    c: Vector
    d: Vector
    vertices: tuple[int, int, int, int]
    size: int


@strict_step
def kept(simplex: Simplex, corners: int) -> Simplex:
    """The simplex of those corners alone, a bit for each."""
    a, b, c, d = simplex.a, simplex.b, simplex.c, simplex.d
    at_a, at_b, at_c, at_d = simplex.vertices
    size = 4
    # from the last on
    if not corners & 8:
        at_d, size = -1, 3
    if not corners & 4:
        c, at_c, at_d = d, at_d, -1
        size -= 1
    if not corners & 2:
        b, at_b, c, at_c, at_d = c, at_c, d, at_d, -1
        size -= 1
    if not corners & 1:
        a, at_a, b, at_b, c, at_c, at_d = b, at_b, c, at_c, d, at_d, -1
        size -= 1
    return Simplex(a, b, c, d, (at_a, at_b, at_c, at_d), size)


@strict_step
def extended(simplex: Simplex, corner: Vector, vertex: int) -> Simplex:
    """The simplex, of three corners at most, and one more."""
    a, b, c, d = simplex.a, simplex.b, simplex.c, simplex.d
    at_a, at_b, at_c, at_d = simplex.vertices
    if simplex.size == 1:
        b, at_b = corner, vertex
    elif simplex.size == 2:
        c, at_c = corner, vertex
    else:
        d, at_d = corner, vertex
    return Simplex(a, b, c, d, (at_a, at_b, at_c, at_d), simplex.size + 1)


@strict_step
def nearest_on(simplex: Simplex) -> Nearest:
    """The point nearest to the origin of a simplex of at least two corners, as `nearest_on_tetrahedron` has it."""
    if simplex.size == 2:
        found = nearest_on_segment(simplex.a, simplex.b)
    elif simplex.size == 3:
        found = nearest_on_triangle(simplex.a, simplex.b, simplex.c)
    else:
        found = nearest_on_tetrahedron(simplex.a, simplex.b, simplex.c, simplex.d)
    return found


@kernel
def nearest_on_segment(a: Vector, b: Vector) -> Nearest:
    """The point of the segment from a to b nearest to the origin."""
    along = minus(b, a)
    part, whole = -dot(along, a), dot(along, along)
    if part <= 0.0:
        return Nearest(a, dot(a, a), 1)
    if part >= whole:
        return Nearest(b, dot(b, b), 2)
    point = plus(a, scaled(along, part / whole))
    # Near the origin the point is little more than rounding. Made perpendicular once more, it is still a direction in
    # which the ends are equally far, and so one that can prove hulls 1e-12 apart separate.
    point = minus(point, scaled(along, dot(point, along) / whole))
    return Nearest(point, dot(point, point), 3)


@kernel
def nearest_on_triangle(a: Vector, b: Vector, c: Vector) -> Nearest:
    """The point of the triangle nearest to the origin."""
    normal = cross(minus(b, a), minus(c, a))
    area = dot(normal, normal)
    # barycentric coordinates of the origin's projection, times the area
    at_a, at_b, at_c = dot(normal, cross(b, c)), dot(normal, cross(c, a)), dot(normal, cross(a, b))
    if area > 0.0 and at_a > 0.0 and at_b > 0.0 and at_c > 0.0:
        # along the normal itself, whose direction stays sharp however near the triangle is
        point = scaled(normal, dot(normal, a) / area)
        return Nearest(point, dot(point, point), 7)
    # beyond an edge, the nearest point lies on an edge that the origin is beyond
    best = Nearest(a, np.inf, 0)
    if at_c <= 0.0 or area <= 0.0:
        best = nearest_on_segment(a, b)
    if at_b <= 0.0 or area <= 0.0:
        point, squared, corners = nearest_on_segment(a, c)
        if squared < best.squared:
            best = Nearest(point, squared, (corners & 1) | (corners & 2) << 1)
    if at_a <= 0.0 or area <= 0.0:
        point, squared, corners = nearest_on_segment(b, c)
        if squared < best.squared:
            best = Nearest(point, squared, corners << 1)
    return best


@kernel
def nearest_on_tetrahedron(a: Vector, b: Vector, c: Vector, d: Vector) -> Nearest:
    """The point nearest to the origin on the three faces at d that the origin is beyond; inside, of all corners.

    The face a b c is left out: the last step came from it, and went towards the origin's side of it.
    """
    best = Nearest((0.0, 0.0, 0.0), np.inf, ALL_CORNERS)
    volume = dot(cross(minus(a, d), minus(b, d)), minus(c, d))
    for face in range(3):
        p, q = (a, b) if face == 0 else ((b, c) if face == 1 else (c, a))
        beyond = dot(cross(minus(p, d), minus(q, d)), d)  # times the volume: whether the origin is on the outer side
        if volume == 0.0 or (beyond >= 0.0) == (volume > 0.0):
            point, squared, corners = nearest_on_triangle(p, q, d)
            if squared < best.squared:
                first, second, third = corners & 1, corners >> 1 & 1, corners >> 2
                if face == 0:
                    carrying = first | second << 1
                elif face == 1:
                    carrying = first << 1 | second << 2
                else:
                    carrying = first << 2 | second
                best = Nearest(point, squared, carrying | third << 3)
    return best


@kernel
def depth_of_origin(a: Vector, b: Vector, c: Vector, d: Vector) -> float:
    """How far the origin is inside a tetrahedron: distance to the nearest face plane, below 0 if outside."""
    volume = dot(cross(minus(a, d), minus(b, d)), minus(c, d))
    sign = 1.0 if volume > 0.0 else -1.0
    depth = depth_below(a, b, d, sign)
    depth = min(depth, depth_below(b, c, d, sign))
    depth = min(depth, depth_below(c, a, d, sign))
    return min(depth, depth_below(a, c, b, sign))


@kernel
def depth_below(a: Vector, b: Vector, c: Vector, sign: float) -> float:
    """Distance of the origin below the plane of a triangle, which is seen counter-clockwise if the sign is -1.

    It is shortened by what rounding may have added: much, if the triangle is a needle.
    """
    left, right = minus(a, c), minus(b, c)
    normal = cross(left, right)
    length = sqrt(dot(normal, normal))
    rounding = ROUNDING * sqrt(dot(left, left) * dot(right, right) * dot(c, c))
    return (-sign * dot(normal, c) - rounding) / length if length > 0.0 else -np.inf


@kernel
def weights(a: Vector, b: Vector, c: Vector, count: int) -> Vector:
    """Barycentric coordinates of the point nearest to the origin, which all of the first `count` corners carry."""
    if count == 1:
        return 1.0, 0.0, 0.0
    if count == 2:
        along = minus(b, a)
        part = min(1.0, max(0.0, -dot(along, a) / dot(along, along)))
        return 1.0 - part, part, 0.0
    normal = cross(minus(b, a), minus(c, a))
    at_a, at_b, at_c = dot(normal, cross(b, c)), dot(normal, cross(c, a)), dot(normal, cross(a, b))
    total = at_a + at_b + at_c
    return at_a / total, at_b / total, at_c / total
