"""Gaps of all close pairs of a frame, of spheres, in one kernel."""

from __future__ import annotations

from harness.arrays import Floats, Pairs
from harness.kernel import kernel
from harness.narrowphase.gap import BEYOND, sphere_gap
from harness.narrowphase.gap_pairs import gaps_of
from harness.narrowphase.pose_gaps import Gaps, write
from harness.narrowphase.vectors import minus, rotation


class SphereGapPairs:
    """Gaps of pairs of spheres.

    Parameters
    ----------
    radii : (n,) float array, m
    """

    def __init__(self, radii: Floats) -> None:
        self._radii = radii

    def gaps(self, pairs: Pairs, positions: Floats, limit: float) -> Gaps:
        """The gaps of pairs, m, and their nearest points, m, in the world; inf and nan beyond a limit.

        Parameters
        ----------
        pairs : (k, 2) int array
        positions : (n, 3) float array, m
        limit : m
        """
        found = gaps_of(len(pairs))
        sphere_pair_gaps(pairs, positions, self._radii, limit, found)
        return found


@kernel
def sphere_pair_gaps(pairs: Pairs, positions: Floats, radii: Floats, limit: float, found: Gaps) -> None:
    """The gap of each pair, written to `found`."""
    straight = rotation(1.0, 0.0, 0.0, 0.0)
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        here = positions[i, 0], positions[i, 1], positions[i, 2]
        gap = sphere_gap(minus((positions[j, 0], positions[j, 1], positions[j, 2]), here), radii[i], radii[j])
        write(found, k, gap if gap.upper <= limit else BEYOND, straight, here)
