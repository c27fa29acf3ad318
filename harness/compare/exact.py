"""Points of placed bodies without any rounding: integers over one common denominator.

Every float is a fraction. A pose turns the float vertices by the exact rotation of its float quaternion, divided by its
exact squared norm, and shifts them by its float position. Of a pair of bodies all coordinates are then multiples of one
unit 1 / (2^k |q1|² |q2|²), so that they can be held as Python integers, which are exact and need no common factors.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from harness.arrays import Floats

Point: TypeAlias = tuple[int, int, int]
Matrix: TypeAlias = tuple[Point, Point, Point]


@dataclass(frozen=True)
class Placed:
    """The points of one body, rigidly placed.

    Parameters
    ----------
    points : (v, 3) float array, m, in the body's own frame
    position : (3,) float array, m
    quaternion : (4,) float array, w x y z; its norm need not be exactly 1
    """

    points: Floats
    position: Floats
    quaternion: Floats


def world_points(first: Placed, second: Placed) -> tuple[list[Point], list[Point], Fraction]:
    """Points of two bodies in the world, exactly.

    Returns
    -------
    first, second : lists of integer points
    unit : m; a coordinate is its integer times this, relative to the position of the first body
    """
    (rotation, norm), (other_rotation, other_norm) = _rotation(first.quaternion), _rotation(second.quaternion)
    rows = [first.points, second.points, first.position[None], second.position[None]]
    scaled, quantum = _integers(np.concatenate(rows))
    count = len(first.points)
    start, end = scaled[-2], scaled[-1]
    shift = [(b - a) * norm * other_norm for a, b in zip(start, end, strict=True)]
    one = [_turned(rotation, (x * other_norm, y * other_norm, z * other_norm)) for x, y, z in scaled[:count]]
    other = [_turned(other_rotation, (x * norm, y * norm, z * norm)) for x, y, z in scaled[count:-2]]
    moved = [(x + shift[0], y + shift[1], z + shift[2]) for x, y, z in other]
    return one, moved, quantum / (norm * other_norm)


def dot(a: Point, b: Point) -> int:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a: Point, b: Point) -> Point:
    """The difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def determinant(a: Point, b: Point, c: Point) -> int:
    """Six times the signed volume of the tetrahedron of the origin and three points."""
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])


def _integers(points: Floats) -> tuple[list[Point], Fraction]:
    """Points as multiples of the largest power of two that all their coordinates are multiples of, and that power."""
    mantissas, exponents = np.frexp(points)
    digits = (mantissas * 2.0**53).astype(np.int64)
    lowest = int(exponents[digits != 0].min(initial=1024))
    shifts = np.where(digits != 0, exponents - lowest, 0)
    rows = zip(digits.tolist(), shifts.tolist(), strict=True)
    scaled = [(x << i, y << j, z << k) for (x, y, z), (i, j, k) in rows]
    return scaled, Fraction(2) ** (lowest - 53)


def _turned(rotation: Matrix, point: Point) -> Point:
    return dot(rotation[0], point), dot(rotation[1], point), dot(rotation[2], point)


def _rotation(quaternion: Floats) -> tuple[Matrix, int]:
    """|q|² times the rotation matrix of q, and |q|², for the quaternion scaled to integers."""
    parts = [Fraction(part) for part in quaternion.tolist()]
    scale = max(part.denominator for part in parts)
    w, x, y, z = (int(part * scale) for part in parts)
    rows = (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )
    return rows, w * w + x * x + y * y + z * z
