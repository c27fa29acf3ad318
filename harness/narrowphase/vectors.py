"""Vectors and rotations of three floats in registers: numba passes tuples by value, where arrays would be counted."""

from __future__ import annotations

from math import sqrt

from harness.kernel import kernel

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
"""Rows."""
Triangle = tuple[Vector, Vector, Vector]
"""Corners."""


@kernel
def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def scaled(a: Vector, factor: float) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


@kernel
def unit(a: Vector) -> Vector:
    """Of length 1, or zero."""
    length = sqrt(dot(a, a))
    return scaled(a, 1.0 / length) if length > 0.0 else a


@kernel
def turned(m: Matrix, a: Vector) -> Vector:
    """m a."""
    return dot(m[0], a), dot(m[1], a), dot(m[2], a)


@kernel
def turned_back(m: Matrix, a: Vector) -> Vector:
    """The transpose of m, times a: the inverse of a rotation."""
    return (
        m[0][0] * a[0] + m[1][0] * a[1] + m[2][0] * a[2],
        m[0][1] * a[0] + m[1][1] * a[1] + m[2][1] * a[2],
        m[0][2] * a[0] + m[1][2] * a[1] + m[2][2] * a[2],
    )


@kernel
def turned_by_both(a: Matrix, b: Matrix) -> Matrix:
    """The transpose of a, times b: the rotation b as seen in the frame that a turns into the world."""
    x = turned_back(a, (b[0][0], b[1][0], b[2][0]))
    y = turned_back(a, (b[0][1], b[1][1], b[2][1]))
    z = turned_back(a, (b[0][2], b[1][2], b[2][2]))
    return (x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])


@kernel
def rotation(w: float, x: float, y: float, z: float) -> Matrix:
    """The matrix of a unit quaternion."""
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
