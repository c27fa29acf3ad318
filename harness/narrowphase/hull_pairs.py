"""All close pairs of a frame, hull against hull, in one kernel: separated, overlapping, or too near to touching to say.

Each pair starts from what settled it in the last frame: the axis that proved it separated, or the simplex that proved
it overlapping. Both are only guesses at where to look. Every verdict is proved anew from the poses at hand, so that
what is remembered changes the time and never the answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.kernel import kernel
from harness.narrowphase.body_shapes import Hulls, hull_of, hulls_of_bodies
from harness.narrowphase.gjk import COLD_START, hull_distance
from harness.narrowphase.placement import Placement, offset_of, pose_of, rotation_of
from harness.narrowphase.separating_axis import gap_along
from harness.narrowphase.support import support_map
from harness.narrowphase.vectors import scaled, turned
from harness.narrowphase.verdicts import PairVerdict, PairVerdicts
from harness.scene.hull import Hull
from harness.threads import Threads

FEWEST_SHARED = 256
"""Pairs that are worth handing over to another thread."""


class Memory(NamedTuple):
    """What settled the pairs of a frame.

    Attributes
    ----------
    keys : (k,) int array, i << 32 | j, ascending
    axes : (k, 3) float array, in the world, from j to i; of no meaning for overlapping pairs
    warm_starts : (k, 4) int array, the simplex of overlapping pairs, else -1
    """

    keys: Ints
    axes: Floats
    warm_starts: Ints

    def since(self, place: int) -> Memory:
        """The memory of the pairs from a place on; the same arrays."""
        return Memory(self.keys[place:], self.axes[place:], self.warm_starts[place:])


class HullPairs:
    """Verdicts on pairs of bodies that have these hulls, in any sizes.

    Parameters
    ----------
    hulls : of diameter 1, of each mesh
    mesh_of : (n,) int array, the number of each body's mesh
    margin : gap or overlap that a certificate must show, of the sum of the sizes
    threads : that share out the pairs of a frame

    Attributes
    ----------
    searches : pairs so far that the axis of the last frame did not settle
    """

    def __init__(self, hulls: Sequence[Hull], mesh_of: Ints, margin: float, threads: Threads | None = None) -> None:
        self._threads = threads or Threads()
        self.searches = 0
        self._margin = margin
        self._hulls = hulls_of_bodies([support_map(hull.vertices) for hull in hulls], mesh_of)
        self._last, self._now, self._remembered = memory(64), memory(64), 0
        self._verdicts: PairVerdicts = np.empty(64, np.int8)

    def settle(self, pairs: Pairs, placement: Placement) -> tuple[PairVerdicts, int, int]:
        """Verdicts on the pairs of a frame.

        Parameters
        ----------
        pairs : (k, 2) int array, sorted; bodies whose bounding spheres touch
        placement : Placement

        Returns
        -------
        verdicts : (k,) int8 array of PairVerdict, overwritten by the next call
        overlapping, undecided : how many pairs are

        Raises
        ------
        ValueError
            For the orientation of a body of a pair that is not a unit quaternion.
        """
        count = len(pairs)
        if count > len(self._verdicts):
            capacity = count + count // 2
            self._verdicts, self._now = np.empty(capacity, np.int8), memory(capacity)
        elif len(self._now.keys) < count:
            self._now = memory(len(self._verdicts))
        parts = self._threads.parts(count, FEWEST_SHARED)
        if len(parts) == 1:
            overlapping, undecided, searches = settle(
                pairs, placement, self._margin, self._hulls, self._last, self._remembered, self._now, self._verdicts
            )
        else:
            found = self._threads.each(lambda begin, end: self._part(pairs[begin:end], begin, placement), parts)
            overlapping, undecided, searches = (sum(counts) for counts in zip(*found, strict=True))
        self._last, self._now, self._remembered = self._now, self._last, count
        self.searches += searches
        return self._verdicts[:count], overlapping, undecided

    def _part(self, pairs: Pairs, begin: int, placement: Placement) -> tuple[int, int, int]:
        """Settle those pairs of a frame that begin at a place in it; what is known of earlier ones is passed over."""
        keys = self._last.keys[: self._remembered]
        known = int(np.searchsorted(keys, pairs[0, 0] << 32 | pairs[0, 1]))
        last, now = self._last.since(known), self._now.since(begin)
        left = self._remembered - known
        return settle(pairs, placement, self._margin, self._hulls, last, left, now, self._verdicts[begin:])


def memory(capacity: int) -> Memory:
    """Uninitialised."""
    return Memory(np.empty(capacity, np.int64), np.empty((capacity, 3)), np.empty((capacity, 4), np.int64))


@kernel
def settle(
    pairs: Pairs,
    placement: Placement,
    margin: float,
    hulls: Hulls,
    last: Memory,
    remembered: int,
    now: Memory,
    verdicts: PairVerdicts,
) -> tuple[int, int, int]:
    """Settle each pair, starting from its memory if it has one, and remember how.

    Parameters
    ----------
    pairs, placement, margin, hulls : as `HullPairs` has them
    last : the Memory of `remembered` pairs
    now : written: the Memory of these pairs
    verdicts : (k,) written

    Returns
    -------
    How many pairs overlap, are undecided, and had to be searched.
    """
    overlapping, undecided, searches = 0, 0, 0
    place = 0
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        key = i << 32 | j
        while place < remembered and last.keys[place] < key:
            place += 1
        offset = offset_of(placement, i, j)
        start, axis = COLD_START, scaled(offset, -1.0)
        if place < remembered and last.keys[place] == key:
            kept = last.warm_starts
            start = kept[place, 0], kept[place, 1], kept[place, 2], kept[place, 3]
            if start[0] < 0:
                axis = last.axes[place, 0], last.axes[place, 1], last.axes[place, 2]
        rotation_i, rotation_j = rotation_of(placement, i), rotation_of(placement, j)
        size_i, size_j = placement.sizes[i], placement.sizes[j]
        needed = margin * (size_i + size_j)
        verdict = PairVerdict.UNDECIDED
        a, b = hull_of(hulls, i), hull_of(hulls, j)
        if start[0] < 0 and gap_along(a, b, axis, rotation_i, size_i, rotation_j, size_j, offset) > needed:
            verdict = PairVerdict.SEPARATE
        else:
            searches += 1
            found = hull_distance(a, b, pose_of(placement, i, j), start, axis, needed, needed, 0.0)
            verdict, axis = found.verdict, turned(rotation_i, found.axis)
            start = found.warm_start if verdict == PairVerdict.TOUCHING else COLD_START
        now.keys[k], verdicts[k] = key, verdict
        now.axes[k, 0], now.axes[k, 1], now.axes[k, 2] = axis
        kept = now.warm_starts
        kept[k, 0], kept[k, 1], kept[k, 2], kept[k, 3] = start
        overlapping += verdict == PairVerdict.TOUCHING
        undecided += verdict == PairVerdict.UNDECIDED
    return overlapping, undecided, searches
