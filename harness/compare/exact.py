"""Points of placed bodies without any rounding: integers over one common denominator.

Every float is a fraction. A pose turns the float vertices by the exact rotation of its float quaternion, divided by its
exact squared norm, and shifts them by its float position. Of a pair of bodies all coordinates are then multiples of one
unit 1 / (2^k |q1|² |q2|²), so that they can be held as Python integers, which are exact and need no common factors.

Of a body of many vertices only few decide. Floats beside the integers, whose error is bounded, leave out those that
cannot be the farthest in a direction; the others alone are made exact, and compared exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias, overload

import numpy as np

from harness.arrays import Floats

Point: TypeAlias = tuple[int, int, int]
Matrix: TypeAlias = tuple[Point, Point, Point]


# Of the largest coordinate: many times what the rotation, the sum and the scalar product of floats can err.
_ROUGH = 1e-12


class Points(Sequence[Point]):
    """Exact points, each made when it is first asked for.

    Parameters
    ----------
    exact : the point at a place
    rough : (n, 3) float array, near the points, in any unit
    """

    def __init__(self, exact: Callable[[int], Point], rough: Floats) -> None:
        self.rough = np.ascontiguousarray(rough)
        self._exact = exact
        self._known: dict[int, Point] = {}
        self._slack = 2 * _ROUGH * float(np.abs(rough).max(initial=0.0))

    @classmethod
    def of(cls, points: Sequence[Point]) -> Points:
        """Points that are there already."""
        return points if isinstance(points, Points) else cls(points.__getitem__, in_floats(points))

    def __len__(self) -> int:
        return len(self.rough)

    @overload
    def __getitem__(self, place: int) -> Point: ...
    @overload
    def __getitem__(self, place: slice) -> list[Point]: ...
    def __getitem__(self, place: int | slice) -> Point | list[Point]:
        if isinstance(place, slice):
            return [self[k] for k in range(*place.indices(len(self)))]
        if not 0 <= place < len(self):
            raise IndexError(place)
        if place not in self._known:
            self._known[place] = self._exact(place)
        return self._known[place]

    def lowest(self, direction: Point) -> int:
        """Which point lies least far along a direction, exactly; the first of several."""
        along = in_floats([direction])[0]
        heights = self.rough @ along
        near = np.flatnonzero(heights <= heights.min() + self._slack * np.abs(along).sum())
        return min(near.tolist(), key=lambda place: dot(direction, self[place])) if len(near) > 1 else int(near[0])

    def highest(self, direction: Point) -> int:
        """Which point lies farthest along a direction, exactly; the first of several."""
        return self.lowest((-direction[0], -direction[1], -direction[2]))

    def shifted(self, by: Point, rough_by: Floats) -> Points:
        """All points moved: by integers, and by floats near them in the unit of the rough ones."""

        def moved(place: int) -> Point:
            x, y, z = self[place]
            return x + by[0], y + by[1], z + by[2]

        return Points(moved, self.rough + rough_by)


def in_floats(points: Sequence[Point]) -> Floats:
    """(n, 3): the points in floats, in a common unit; integers may be too large for one."""
    excess = max(0, max(abs(part).bit_length() for point in points for part in point) - 512)
    return np.array([[float(part >> excess) for part in point] for point in points])


@dataclass(frozen=True)
class PlacedPoints:
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


def world_points(first: PlacedPoints, second: PlacedPoints) -> tuple[Points, Points, Fraction]:
    """Points of two bodies in the world, exactly.

    Returns
    -------
    first, second : Points
        Their rough coordinates are in m, relative to the position of the first body.
    unit : m; a coordinate is its integer times this, relative to the position of the first body
    """
    (rotation, norm), (other_rotation, other_norm) = _rotation(first.quaternion), _rotation(second.quaternion)
    rows = [first.points, second.points, first.position[None], second.position[None]]
    scaled, quantum = _integers(np.concatenate(rows))
    count, total = len(first.points), len(first.points) + len(second.points)
    shift = [(b - a) * norm * other_norm for a, b in zip(scaled(total), scaled(total + 1), strict=True)]

    def one(place: int) -> Point:
        x, y, z = scaled(place)
        return _turned(rotation, (x * other_norm, y * other_norm, z * other_norm))

    def other(place: int) -> Point:
        x, y, z = scaled(count + place)
        x, y, z = _turned(other_rotation, (x * norm, y * norm, z * norm))
        return x + shift[0], y + shift[1], z + shift[2]

    apart = second.position - first.position
    rough = _rough(first), _rough(second) + apart
    return Points(one, rough[0]), Points(other, rough[1]), quantum / (norm * other_norm)


def dot(a: Point, b: Point) -> int:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a: Point, b: Point) -> Point:
    """The difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def determinant(a: Point, b: Point, c: Point) -> int:
    """Six times the signed volume of the tetrahedron of the origin and three points."""
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])


def _rough(placed: PlacedPoints) -> Floats:
    """The points turned, in floats."""
    w, x, y, z = placed.quaternion.tolist()
    norm = w * w + x * x + y * y + z * z
    rows = np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )
    # not by BLAS, whose threads wait longer than this takes
    return np.asarray(np.einsum("ij,kj->ik", placed.points, rows / norm), np.float64)


def _integers(points: Floats) -> tuple[Callable[[int], Point], Fraction]:
    """Points as multiples of the largest power of two that all their coordinates are multiples of, and that power."""
    mantissas, exponents = np.frexp(points)
    digits = (mantissas * 2.0**53).astype(np.int64)
    lowest = int(exponents[digits != 0].min(initial=1024))
    shifts = np.where(digits != 0, exponents - lowest, 0)

    def scaled(place: int) -> Point:
        (x, y, z), (i, j, k) = digits[place].tolist(), shifts[place].tolist()
        return x << i, y << j, z << k

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
