"""Proofs that two bodies in free flight touch at an instant.

Two triangles touch when an edge of one has its ends on both sides of the other and runs inside of its three edges: five
determinants of strict signs. The corners are integers, in units of 2^-256 m, with a bound on how far they are from the
real numbers: sine and cosine are summed as series of fractions, so that nothing is left to a library. Of bodies that do
not turn, or at time 0, the corners are fractions, and touch even where they only just do.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import isqrt, lcm
from typing import NamedTuple, TypeAlias

from harness.compare.convex import CommonPoint, meet
from harness.compare.exact import Point, determinant, minus

BITS = 256
_ONE = 1 << BITS
# Of a corner, in units: see `_spin_quaternion` and `_fixed_corner`.
_ERROR = 1 << 64
# What those bounds are made for: m of a coordinate, and rad of a turn.
FARTHEST, MOST_TURNED = 1 << 20, 1 << 17

Numbers: TypeAlias = Sequence[float]
Corners: TypeAlias = Sequence[Sequence[float]]


class FlyingBody(NamedTuple):
    """One body of a case, in plain numbers; attributes as of `Flights`."""

    size: float
    position: Numbers
    quaternion: Numbers
    velocity: Numbers
    spin: Numbers

    def turns(self, time: float) -> bool:
        """Whether it has turned at a time."""
        return time != 0.0 and any(self.spin)


def spheres_touch(first: FlyingBody, second: FlyingBody, time: float) -> bool:
    """Whether two spheres, whose diameters are the sizes, touch: exactly."""
    between = [b - a for a, b in zip(_centre(first, time), _centre(second, time), strict=True)]
    reach = (Fraction(first.size) + Fraction(second.size)) / 2
    return sum(part * part for part in between) <= reach * reach


def triangles_touch(
    first: FlyingBody, second: FlyingBody, time: float, pairs: Iterable[tuple[Corners, Corners]]
) -> bool:
    """Whether one of some pairs of triangles of both bodies is proven to touch.

    Parameters
    ----------
    first, second : FlyingBody
    time : s
    pairs : corners of both, in the units of their meshes
    """
    if first.turns(time) or second.turns(time):
        frames = _fixed_frame(first, time), _fixed_frame(second, time)
        return any(
            _cross(*([_fixed_corner(frame, c) for c in some] for frame, some in zip(frames, both, strict=True)))
            for both in pairs
        )
    return any(
        _meet(*([_exact_corner(body, time, c) for c in some] for body, some in zip((first, second), both, strict=True)))
        for both in pairs
    )


def _centre(body: FlyingBody, time: float) -> list[Fraction]:
    return [Fraction(x) + Fraction(v) * Fraction(time) for x, v in zip(body.position, body.velocity, strict=True)]


# Exactly.


def _exact_corner(body: FlyingBody, time: float, corner: Numbers) -> list[Fraction]:
    w, x, y, z = (Fraction(part) for part in body.quaternion)
    scale = Fraction(body.size) / (w * w + x * x + y * y + z * z)
    rows = _matrix(w, x, y, z)
    return [
        c + scale * sum(a * Fraction(b) for a, b in zip(row, corner, strict=True))
        for row, c in zip(rows, _centre(body, time), strict=True)
    ]


def _meet(one: list[list[Fraction]], other: list[list[Fraction]]) -> bool:
    """Whether two triangles have a common point."""
    unit = lcm(*(part.denominator for corner in one + other for part in corner))
    whole: list[Point] = [tuple(int(part * unit) for part in corner) for corner in one + other]  # type: ignore[misc]
    found = meet(whole[:3], whole[3:])
    return isinstance(found, CommonPoint) and found.holds(whole[:3], whole[3:])


def _matrix(w: Fraction, x: Fraction, y: Fraction, z: Fraction) -> list[list[Fraction]]:
    """|q|² times the rotation."""
    return [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]


# In integers of a known error.


class _Frame(NamedTuple):
    """Where a body is, in units: the rows of its rotation, and its centre; and its size, m."""

    rows: tuple[Point, Point, Point]
    centre: Point
    size: Fraction


def _fixed_frame(body: FlyingBody, time: float) -> _Frame:
    w, x, y, z = _product(_spin_quaternion(body.spin, time), _unit_quaternion(body.quaternion))
    rows = (
        (
            _ONE - 2 * _times(y, y) - 2 * _times(z, z),
            2 * (_times(x, y) - _times(w, z)),
            2 * (_times(x, z) + _times(w, y)),
        ),
        (
            2 * (_times(x, y) + _times(w, z)),
            _ONE - 2 * _times(x, x) - 2 * _times(z, z),
            2 * (_times(y, z) - _times(w, x)),
        ),
        (
            2 * (_times(x, z) - _times(w, y)),
            2 * (_times(y, z) + _times(w, x)),
            _ONE - 2 * _times(x, x) - 2 * _times(y, y),
        ),
    )
    a, b, c = (_fixed(part) for part in _centre(body, time))
    return _Frame(rows, (a, b, c), Fraction(body.size))


def _fixed_corner(frame: _Frame, corner: Numbers) -> Point:
    """A corner in units, each coordinate off by no more than `_ERROR`.

    The quaternion is off by 2^36 units (see `_spin_quaternion`), an entry of the matrix by 4 times that and some, and
    so a coordinate by 2^40 for each m that the corner is from the centre, of which there are at most 2^20.
    """
    scaled = [_fixed(frame.size * Fraction(part)) for part in corner]
    if max(map(abs, (*scaled, *frame.centre))) > FARTHEST * _ONE:
        raise ArithmeticError(f"a corner is farther than {FARTHEST} m from where it is measured")
    x, y, z = (
        c + sum(_times(a, b) for a, b in zip(row, scaled, strict=True))
        for row, c in zip(frame.rows, frame.centre, strict=True)
    )
    return x, y, z


def _spin_quaternion(spin: Numbers, time: float) -> tuple[int, int, int, int]:
    """The quaternion of exp(w t), in units; off by less than 2^35.

    The turn is halved until its half is below 1/8 rad, where 20 terms of the series are right to a unit and their
    roundings add up to less than 2^9; and squared as often, at most 21 times, by which an error grows to 2.1 of itself
    and 10.
    """
    half = [Fraction(part) * Fraction(time) / 2 for part in spin]
    squared, halvings = sum(part * part for part in half), 0
    if squared > MOST_TURNED**2:
        raise ArithmeticError(f"a body turns by more than {2 * MOST_TURNED} rad")
    while squared * 64 >= 4**halvings:
        halvings += 1
    x, y, z = (_fixed(part / 2**halvings) for part in half)
    angle = _times(x, x) + _times(y, y) + _times(z, z)
    cosine, sine, term = 0, 0, _ONE
    for k in range(21):
        cosine += term
        term //= 2 * k + 1
        sine += term
        term = -_times(term, angle) // (2 * k + 2)
    q = cosine, _times(sine, x), _times(sine, y), _times(sine, z)
    for _ in range(halvings):
        q = _product(q, q)
    return q


def _unit_quaternion(quaternion: Numbers) -> tuple[int, int, int, int]:
    """In units, off by a few."""
    parts = [Fraction(part) for part in quaternion]
    unit = lcm(*(part.denominator for part in parts))
    whole = [int(part * unit) for part in parts]
    length = isqrt(sum(part * part for part in whole) << 2 * BITS)
    w, x, y, z = ((part << 2 * BITS) // length for part in whole)
    return w, x, y, z


def _product(p: tuple[int, int, int, int], q: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    a, b, c, d = p
    w, x, y, z = q
    return (
        _times(a, w) - _times(b, x) - _times(c, y) - _times(d, z),
        _times(a, x) + _times(b, w) + _times(c, z) - _times(d, y),
        _times(a, y) - _times(b, z) + _times(c, w) + _times(d, x),
        _times(a, z) + _times(b, y) - _times(c, x) + _times(d, w),
    )


def _times(a: int, b: int) -> int:
    return (a * b) >> BITS


def _fixed(number: Fraction) -> int:
    return (number.numerator << BITS) // number.denominator


def _cross(one: Sequence[Point], other: Sequence[Point]) -> bool:
    """Whether an edge of one of two triangles surely runs through the other."""
    return _pierced(one, other) or _pierced(other, one)


def _pierced(edged: Sequence[Point], triangle: Sequence[Point]) -> bool:
    a, b, c = triangle
    sides = [_side(a, b, c, corner) for corner in edged]
    for k in range(3):
        m = (k + 1) % 3
        if sides[k] * sides[m] < 0:
            p, q = edged[k], edged[m]
            around = {_side(p, q, a, b), _side(p, q, b, c), _side(p, q, c, a)}
            if around in ({1}, {-1}):
                return True
    return False


def _side(a: Point, b: Point, c: Point, d: Point) -> int:
    """The sign of the volume of a tetrahedron; 0 if the errors of the corners could change it.

    A determinant is six products of three coordinates, each off by twice `_ERROR`, so it is off by less than 36 times
    `_ERROR` and the square of the longest.
    """
    rows = minus(a, d), minus(b, d), minus(c, d)
    volume = determinant(*rows)
    longest = max(abs(part) for row in rows for part in row) + 2 * _ERROR
    if abs(volume) <= 36 * longest * longest * _ERROR:
        return 0
    return 1 if volume > 0 else -1
