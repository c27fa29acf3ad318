"""All pairs: the reference for every other broad phase, and the fastest one for a few dozen bodies."""

import numpy as np
from numpy.typing import ArrayLike

from harness.arrays import Floats, Pairs
from harness.broadphase.pairs import checked_positions, checked_radii, require_finite, touching
from harness.kernel import kernel


class BruteForce:
    """Every pair, every frame. See `BroadPhase`.

    Parameters
    ----------
    radii : (n,) array, m
    """

    def __init__(self, radii: ArrayLike) -> None:
        self.radii = checked_radii(radii)
        self.pair_tests = 0

    def close_pairs(self, positions: ArrayLike) -> Pairs:
        """Pairs of bodies whose bounding spheres touch, as `BroadPhase.close_pairs` defines them."""
        count = len(self.radii)
        pairs = all_close_pairs(checked_positions(positions, count), self.radii)
        self.pair_tests += count * (count - 1) // 2
        return pairs


@kernel
def all_close_pairs(positions: Floats, radii: Floats) -> Pairs:
    """Count the hits of each row, eight bodies at a time, then list those of the few rows that have any."""
    require_finite(positions)
    n = len(radii)
    # By coordinate, or counting is not vectorised: seven times slower.
    x, y, z = positions[:, 0].copy(), positions[:, 1].copy(), positions[:, 2].copy()
    hits = np.empty(n, np.int64)
    for i in range(n):
        hits[i] = later_hits(x[i:], y[i:], z[i:], radii[i:])
    pairs = np.empty((hits.sum(), 2), np.int64)
    k = 0
    for i in range(n):
        if hits[i] > 0:
            list_later_hits(i, x[i:], y[i:], z[i:], radii[i:], pairs[k : k + hits[i]])
            k += hits[i]
    return pairs


@kernel
def later_hits(x: Floats, y: Floats, z: Floats, radii: Floats) -> int:
    """How many of the bodies touch the first of them."""
    hits = 0
    x0, y0, z0, r0 = x[0], y[0], z[0], radii[0]
    x, y, z, radii = x[1:], y[1:], z[1:], radii[1:]  # counted from 0, or the loop is not vectorised
    for j in range(len(x)):
        if touching(x0 - x[j], y0 - y[j], z0 - z[j], r0 + radii[j]):
            hits += 1
    return hits


@kernel
def list_later_hits(i: int, x: Floats, y: Floats, z: Floats, radii: Floats, pairs: Pairs) -> None:
    """Fill `pairs` with (i, i + j) for the bodies j that touch the first of them, which is body i."""
    k, j = 0, 0
    x0, y0, z0, r0 = x[0], y[0], z[0], radii[0]
    while k < len(pairs):
        j += 1
        if touching(x0 - x[j], y0 - y[j], z0 - z[j], r0 + radii[j]):
            pairs[k, 0] = i
            pairs[k, 1] = i + j
            k += 1
