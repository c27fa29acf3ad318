"""The point of a segment, triangle or tetrahedron nearest to the origin, and which corners carry it.

Steps of the Gilbert-Johnson-Keerthi algorithm. Regions are told by the signs of triple products about the origin, and
a flat triangle or tetrahedron is replaced by its edges or faces, so that no division is by a vanishing area.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from harness.kernel import kernel
from harness.narrowphase.vectors import Vector, cross, dot, minus, plus, scaled

# Of the product of the lengths: the most that rounding changes a triple product, and some more.
ROUNDING = 2e-15

Nearest = tuple[Vector, float, int]
"""The nearest point, its squared distance, and a bit for each corner that carries it (the first is 1)."""


@kernel
def nearest_on_segment(a: Vector, b: Vector) -> Nearest:
    """The point of the segment from a to b nearest to the origin."""
    along = minus(b, a)
    part, whole = -dot(along, a), dot(along, along)
    if part <= 0.0:
        return a, dot(a, a), 1
    if part >= whole:
        return b, dot(b, b), 2
    point = plus(a, scaled(along, part / whole))
    # Near the origin the point is little more than rounding. Made perpendicular once more, it is still a direction in
    # which the ends are equally far, and so one that can prove hulls 1e-12 apart separate.
    point = minus(point, scaled(along, dot(point, along) / whole))
    return point, dot(point, point), 3


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
        return point, dot(point, point), 7
    # beyond an edge, the nearest point lies on an edge that the origin is beyond
    best: Nearest = (a, np.inf, 0)
    if at_c <= 0.0 or area <= 0.0:
        best = nearest_on_segment(a, b)
    if at_b <= 0.0 or area <= 0.0:
        point, squared, corners = nearest_on_segment(a, c)
        if squared < best[1]:
            best = point, squared, (corners & 1) | (corners & 2) << 1
    if at_a <= 0.0 or area <= 0.0:
        point, squared, corners = nearest_on_segment(b, c)
        if squared < best[1]:
            best = point, squared, corners << 1
    return best


@kernel
def nearest_on_tetrahedron(a: Vector, b: Vector, c: Vector, d: Vector) -> Nearest:
    """The point nearest to the origin on the three faces at d that the origin is beyond; inside, corners are 15.

    The face a b c is left out: the last step came from it, and went towards the origin's side of it.
    """
    best: Nearest = ((0.0, 0.0, 0.0), np.inf, 15)
    volume = dot(cross(minus(a, d), minus(b, d)), minus(c, d))
    for face in range(3):
        p, q = (a, b) if face == 0 else ((b, c) if face == 1 else (c, a))
        beyond = dot(cross(minus(p, d), minus(q, d)), d)  # times the volume: whether the origin is on the outer side
        if volume == 0.0 or (beyond >= 0.0) == (volume > 0.0):
            point, squared, corners = nearest_on_triangle(p, q, d)
            if squared < best[1]:
                first, second, third = corners & 1, corners >> 1 & 1, corners >> 2
                if face == 0:
                    kept = first | second << 1
                elif face == 1:
                    kept = first << 1 | second << 2
                else:
                    kept = first << 2 | second
                best = point, squared, kept | third << 3
    return best


@kernel
def room_around_origin(a: Vector, b: Vector, c: Vector, d: Vector) -> float:
    """How far the origin is inside a tetrahedron: distance to the nearest face plane, below 0 if outside."""
    volume = dot(cross(minus(a, d), minus(b, d)), minus(c, d))
    sign = 1.0 if volume > 0.0 else -1.0
    room = depth_below(a, b, d, sign)
    room = min(room, depth_below(b, c, d, sign))
    room = min(room, depth_below(c, a, d, sign))
    return min(room, depth_below(a, c, b, sign))


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
