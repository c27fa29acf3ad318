"""Where exact arithmetic should begin to look, by floats: the points between which two sets are probably nearest.

Nothing that is found here is believed. It spares exact steps, of which each costs as much as a walk of floats to its
end; where floats are wrong, the exact ones go on from there.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel

_MOST_STEPS = 100
# Relative: a step that comes no nearer than that is the last.
_PROGRESS = 1e-15


@kernel
def probable_simplex(first: Floats, second: Floats) -> Ints:
    """The pairs of points whose differences probably span the point of all differences that is nearest to the origin.

    The algorithm of Gilbert, Johnson and Keerthi (1988); supports are found among all points.

    Parameters
    ----------
    first, second : (n, 3) and (m, 3) float arrays, in the same unit

    Returns
    -------
    (k, 2) int array
        A point of the first and one of the second each, k from 1 to 4.
    """
    corners, pairs = np.empty((4, 3)), np.zeros((4, 2), np.int64)
    corners[0] = first[0] - second[0]
    count, before = 1, np.inf
    nearest = np.empty(3)
    for _ in range(_MOST_STEPS):
        kept = probable_corners(corners[:count], nearest)
        place = 0
        for corner in range(count):
            if kept & (1 << corner):
                corners[place], pairs[place] = corners[corner], pairs[corner]
                place += 1
        count = place
        squared = nearest[0] ** 2 + nearest[1] ** 2 + nearest[2] ** 2
        if count == 4 or not squared < before:
            break
        before = squared
        least, most = _lowest(first, nearest, 1.0), _lowest(second, nearest, -1.0)
        along = 0.0
        for axis in range(3):
            along += nearest[axis] * (first[least, axis] - second[most, axis])
        if squared - along <= _PROGRESS * squared:
            break
        known = False
        for corner in range(count):
            known |= pairs[corner, 0] == least and pairs[corner, 1] == most
        if known:
            break
        pairs[count, 0], pairs[count, 1] = least, most
        corners[count] = first[least] - second[most]
        count += 1
    found: Ints = pairs[:count].copy()
    return found


@kernel
def probable_corners(corners: Floats, nearest: Floats) -> int:
    """Which of up to four corners probably span the point of their hull that is nearest to the origin, as bits.

    Of every set of them the nearest point of its span is worked out; of those that lie inside, one is the nearest.

    Parameters
    ----------
    corners : (k, 3) float array
    nearest : (3,) float array, which that point is written to
    """
    count = len(corners)
    weights = np.empty(4)
    best, least = 1, np.inf
    for kept in range(1, 1 << count):
        chosen, size = np.empty((4, 3)), 0
        for corner in range(count):
            if kept & (1 << corner):
                chosen[size] = corners[corner]
                size += 1
        _weigh(chosen, size, weights)
        total, inside = 0.0, True
        for corner in range(size):
            total += weights[corner]
            inside &= weights[corner] > 0.0
        if not inside:
            continue
        x, y, z = 0.0, 0.0, 0.0
        for corner in range(size):
            share = weights[corner] / total
            x += share * chosen[corner, 0]
            y += share * chosen[corner, 1]
            z += share * chosen[corner, 2]
        squared = x * x + y * y + z * z
        if size == 4:
            squared = 0.0  # the origin lies within, however the sum is rounded
        if squared < least:
            best, least = kept, squared
            nearest[0], nearest[1], nearest[2] = x, y, z
    return best


@kernel
def _weigh(corners: Floats, count: int, weights: Floats) -> None:
    """Weights of the point nearest to the origin on the span of some corners; not all positive if it lies outside."""
    a, b, c, d = corners[0], corners[1], corners[2], corners[3]
    if count == 1:
        weights[0] = 1.0
    elif count == 2:
        length, along = 0.0, 0.0
        for axis in range(3):
            edge = b[axis] - a[axis]
            length += edge * edge
            along -= edge * a[axis]
        weights[0], weights[1] = length - along, along
    elif count == 3:
        ee, ef, ff, es, fs = 0.0, 0.0, 0.0, 0.0, 0.0
        for axis in range(3):
            e, f = b[axis] - a[axis], c[axis] - a[axis]
            ee += e * e
            ef += e * f
            ff += f * f
            es -= e * a[axis]
            fs -= f * a[axis]
        weights[1], weights[2] = es * ff - fs * ef, ee * fs - ef * es
        weights[0] = ee * ff - ef * ef - weights[1] - weights[2]
    else:
        weights[0], weights[1] = _volume(b, c, d), -_volume(a, c, d)
        weights[2], weights[3] = _volume(a, b, d), -_volume(a, b, c)
        if weights[0] + weights[1] + weights[2] + weights[3] < 0.0:
            for corner in range(4):
                weights[corner] = -weights[corner]


@kernel
def _volume(a: Floats, b: Floats, c: Floats) -> float:
    return float(
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


@kernel
def _lowest(points: Floats, direction: Floats, sign: float) -> int:
    """Which point lies least far along a direction times a sign."""
    x, y, z = sign * direction[0], sign * direction[1], sign * direction[2]
    best, least = 0, np.inf
    for place in range(len(points)):
        height = x * points[place, 0] + y * points[place, 1] + z * points[place, 2]
        if height < least:
            best, least = place, height
    return best
