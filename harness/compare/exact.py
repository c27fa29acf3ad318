"""Points of placed bodies without any rounding: integers over one common denominator.

Every float is a fraction. A pose turns the float vertices by the exact rotation of its float quaternion, divided by its
exact squared norm, and shifts them by its float position. Of a pair of bodies all coordinates are then multiples of one
unit 1 / (2^k |q1|² |q2|²), so that they can be held as Python integers, which are exact and need no common factors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

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
    between = [
        Fraction(b) - Fraction(a) for a, b in zip(first.position.tolist(), second.position.tolist(), strict=True)
    ]
    rows = [_fractions(body.points) for body in (first, second)]
    # denominators of floats are powers of two, so the largest of them is a multiple of every other
    denominator = max(
        *(number.denominator for number in between),
        *(number.denominator for body in rows for row in body for number in row),
    )
    shift = [int(number * denominator) * norm * other_norm for number in between]
    one = [_turned(rotation, _scaled(row, denominator * other_norm)) for row in rows[0]]
    other = [_turned(other_rotation, _scaled(row, denominator * norm)) for row in rows[1]]
    moved = [(x + shift[0], y + shift[1], z + shift[2]) for x, y, z in other]
    return one, moved, Fraction(1, denominator * norm * other_norm)


def dot(a: Point, b: Point) -> int:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a: Point, b: Point) -> Point:
    """The difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def determinant(a: Point, b: Point, c: Point) -> int:
    """Six times the signed volume of the tetrahedron of the origin and three points."""
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])


def _fractions(points: Floats) -> list[list[Fraction]]:
    return [[Fraction(x) for x in row] for row in points.tolist()]


def _scaled(row: Sequence[Fraction], factor: int) -> Point:
    x, y, z = (number.numerator * (factor // number.denominator) for number in row)
    return x, y, z


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
