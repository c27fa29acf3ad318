"""Distance of two triangles, certified from both sides.

The walk of Gilbert, Johnson and Keerthi (1988) through the differences of the corners needs no cases for edges and
faces, and none for triangles that are needles or points. It ends at a pair of points, an upper bound, and at an axis
along which the corners themselves show the lower bound.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel
from harness.narrowphase.simplex import (
    ALL_CORNERS,
    Nearest,
    Simplex,
    depth_of_origin,
    extended,
    kept,
    nearest_on,
    nearest_on_triangle,
)
from harness.narrowphase.vectors import Triangle, Vector, dot, minus, plus, unit

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


class Walk(NamedTuple):
    """How a walk ended.

    Attributes
    ----------
    lower, upper, axis : as of a `TriangleDistance`
    simplex : of the differences of corners, whose point nearest to the origin is the shortest connection; of four
        corners, if they hold the origin
    """

    lower: float
    upper: float
    axis: Vector
    simplex: Simplex


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
    found = walk(one, other, minus(middle_one, middle_other), margin, np.inf)
    return TriangleDistance(found.lower, found.upper, found.axis)


@kernel
def walk(one: Triangle, other: Triangle, towards: Vector, margin: float, enough: float) -> Walk:
    """The walk towards the shortest connection of two triangles.

    Parameters
    ----------
    one, other : Triangle
    towards : the first guess at the direction from the second to the first; zero is as good as none
    margin : a distance that need not be told from 0
    enough : a distance that need not be known better
    """
    point, corner, _ = lowest(one, other, towards)
    simplex = Simplex(point, point, point, point, (corner, -1, -1, -1), 1)
    nearest = Nearest(point, dot(point, point), 1)
    lower, axis = 0.0, point
    for _ in range(MOST_STEPS):
        squared = nearest.squared
        if squared <= margin * margin:
            return Walk(0.0, sqrt(squared), unit(axis), simplex)
        point, corner, along = lowest(one, other, nearest.point)
        if along > 0.0 and along > lower * sqrt(squared):
            lower, axis = along / sqrt(squared), nearest.point
            if lower > enough:
                break
        if squared - along <= PRECISION * squared or corner in simplex.vertices:
            break
        larger = extended(simplex, point, corner)
        step = nearest_on(larger)
        if step.corners == ALL_CORNERS:
            if depth_of_origin(larger.a, larger.b, larger.c, larger.d) > 0.0:
                return Walk(0.0, 0.0, unit(axis), larger)
            step = nearest_on_flat(larger.a, larger.b, larger.c, larger.d)
        if not step.squared < squared:  # rounding ends the descent
            break
        simplex, nearest = kept(larger, step.corners), step
    return Walk(lower, max(lower, sqrt(nearest.squared)), unit(axis), simplex)


@kernel
def nearest_on_flat(a: Vector, b: Vector, c: Vector, d: Vector) -> Nearest:
    """The point nearest to the origin on the faces at d of a tetrahedron too flat to tell its sides: parallel edges."""
    point, squared, corners = nearest_on_triangle(a, b, d)
    best = Nearest(point, squared, corners & 3 | (corners & 4) << 1)
    point, squared, corners = nearest_on_triangle(b, c, d)
    if squared < best.squared:
        best = Nearest(point, squared, corners << 1)
    point, squared, corners = nearest_on_triangle(a, c, d)
    if squared < best.squared:
        best = Nearest(point, squared, corners & 1 | (corners & 6) << 1)
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
