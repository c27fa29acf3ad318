"""Vectors of many cells at once: the coordinate is the first axis of an array, the cell the last."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def cross(a: Floats, b: Floats) -> Floats:
    """Vector products."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def norm(a: Floats) -> Floats:
    """Lengths."""
    return np.asarray(np.sqrt(dot(a, a)))


def normalised(a: Floats) -> Floats:
    """Vectors of any dimension at a length of 1, up to rounding; a vector of length 0 as it is."""
    length = np.sqrt((a * a).sum(axis=0))
    return np.asarray(a / np.where(length > 0.0, length, 1.0))


def rotations(quaternions: Floats, spins: Floats, times: Floats) -> Floats:
    """(3, 3, k): how bodies are turned at times (s): exp(w t) q, as matrices.

    Parameters
    ----------
    quaternions : (4, k) float array, unit, w x y z
    spins : (3, k) float array, rad/s
    times : (k,) float array, s
    """
    rate = norm(spins)
    half = 0.5 * rate * times
    c, s = np.cos(half), np.sin(half) / np.where(rate > 0.0, rate, 1.0)
    x, y, z = s * spins[0], s * spins[1], s * spins[2]
    w0, x0, y0, z0 = quaternions
    w, x, y, z = (
        c * w0 - x * x0 - y * y0 - z * z0,
        c * x0 + x * w0 + y * z0 - z * y0,
        c * y0 - x * z0 + y * w0 + z * x0,
        c * z0 + x * y0 - y * x0 + z * w0,
    )
    return np.stack(
        [
            np.stack([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)]),
            np.stack([2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)]),
            np.stack([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)]),
        ]
    )


def turned(matrices: Floats, vectors: Floats) -> Floats:
    """Vectors turned by (3, 3, k) matrices."""
    return np.stack([dot(row, vectors) for row in matrices])
