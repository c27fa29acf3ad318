"""Pairs of a frame whose hulls overlap, surface against surface, in one kernel: proved to touch, not to, or neither.

The search starts around the triangles that crossed in the last frame, and from the whole surfaces if that fails.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from harness.arrays import Ints, Pairs
from harness.kernel import kernel
from harness.narrowphase.body_shapes import Surfaces, tree_of, trees_of_bodies
from harness.narrowphase.crossing import find_crossing
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.placement import Placement, pose_of
from harness.narrowphase.tree_pairs import DEPTH, ROOTS, NodePair, Trees
from harness.narrowphase.triangle_tree import triangle_tree
from harness.narrowphase.verdicts import PairVerdict, PairVerdicts
from harness.scene.mesh import Mesh
from harness.threads import Threads

# How many levels above the triangles that crossed the search starts, and for how many steps it looks there and from
# the root. With this start it takes a third less time than without.
LEVELS_UP = 3
NEARBY_STEPS = 100
STEPS = 20_000

FEWEST_SHARED = 32
"""Pairs that are worth handing over to another thread."""


class Crossings(NamedTuple):
    """Where the surfaces of a frame cross.

    Attributes
    ----------
    keys : (capacity,) int array, i << 32 | j, ascending
    leaves : (capacity, 2) int array, of triangles that cross
    """

    keys: Ints
    leaves: Ints

    def since(self, place: int) -> Crossings:
        """Those of the pairs from a place on; the same arrays."""
        return Crossings(self.keys[place:], self.leaves[place:])


class MeshPairs:
    """Verdicts on pairs of bodies with these surfaces, in any sizes.

    Parameters
    ----------
    meshes : that there are
    mesh_of : (n,) int array, the number of each body's mesh
    threads : that share out the pairs of a frame
    """

    def __init__(self, meshes: Sequence[Mesh], mesh_of: Ints, threads: Threads | None = None) -> None:
        self._threads = threads or Threads()
        self._trees = trees_of_bodies([triangle_tree(mesh.vertices, mesh.faces) for mesh in meshes], mesh_of)
        self._stack = np.empty((DEPTH, 2), np.int64)
        self._last, self._now, self._remembered = crossings(0), crossings(0), 0

    def settle(self, pairs: Pairs, placement: Placement) -> PairVerdicts:
        """Verdicts on the pairs of a frame: TOUCHING, where the surfaces cross.

        Parameters
        ----------
        pairs : (k, 2) int array, sorted
        placement : Placement
        """
        if len(pairs) > len(self._now.keys):
            self._now = crossings(len(pairs) + len(pairs) // 2)
        verdicts = np.empty(len(pairs), np.int8)
        last = Crossings(self._last.keys[: self._remembered], self._last.leaves)
        parts = self._threads.parts(len(pairs), FEWEST_SHARED)
        if len(parts) == 1:
            self._remembered = settle(pairs, placement, self._trees, self._stack, last, self._now, verdicts)
        else:
            self._remembered = self._shared(pairs, placement, last, verdicts, parts)
        self._last, self._now = self._now, self._last
        return verdicts

    def _shared(
        self,
        pairs: Pairs,
        placement: Placement,
        last: Crossings,
        verdicts: PairVerdicts,
        parts: tuple[tuple[int, int], ...],
    ) -> int:
        """The same for each part of the pairs; how many cross, whose memory is then moved together."""
        now = self._now

        def part(begin: int, end: int) -> int:
            some, stack = pairs[begin:end], np.empty_like(self._stack)
            known = int(np.searchsorted(last.keys, some[0, 0] << 32 | some[0, 1]))
            before, written = last.since(known), now.since(begin)
            return settle(some, placement, self._trees, stack, before, written, verdicts[begin:end])

        count = 0
        for (begin, _), crossing in zip(parts, self._threads.each(part, parts), strict=True):
            now.keys[count : count + crossing] = now.keys[begin : begin + crossing]
            now.leaves[count : count + crossing] = now.leaves[begin : begin + crossing]
            count += crossing
        return count


def crossings(capacity: int) -> Crossings:
    """Uninitialised."""
    return Crossings(np.empty(capacity, np.int64), np.empty((capacity, 2), np.int64))


@kernel
def settle(
    pairs: Pairs,
    placement: Placement,
    surfaces: Surfaces,
    stack: Ints,
    last: Crossings,
    now: Crossings,
    verdicts: PairVerdicts,
) -> int:
    """Settle each pair, and remember where surfaces cross.

    Parameters
    ----------
    pairs, placement : as `MeshPairs.settle` has them
    surfaces : of the bodies
    stack : (DEPTH, 2) written
    last : Crossings of the last frame
    now : the same of this frame, written
    verdicts : (k,) written

    Returns
    -------
    How many cross.
    """
    place, count = 0, 0
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        key = i << 32 | j
        pose, trees = pose_of(placement, i, j), Trees(tree_of(surfaces, i), tree_of(surfaces, j))
        margin = MARGIN * (pose.size_a + pose.size_b)
        while place < len(last.keys) and last.keys[place] < key:
            place += 1
        start, most_steps, again = ROOTS, STEPS, False
        if place < len(last.keys) and last.keys[place] == key:
            start, most_steps, again = NodePair(last.leaves[place, 0], last.leaves[place, 1]), NEARBY_STEPS, True
            for _ in range(LEVELS_UP):
                start = NodePair(trees.a.parent[start.a], trees.b.parent[start.b])
        found = find_crossing(trees, pose, start, margin, most_steps, stack)
        if found.verdict != PairVerdict.TOUCHING and again:
            found = find_crossing(trees, pose, ROOTS, margin, STEPS, stack)
        verdicts[k] = found.verdict
        if found.verdict == PairVerdict.TOUCHING:
            now.keys[count] = key
            now.leaves[count, 0], now.leaves[count, 1] = found.leaves
            count += 1
    return count
