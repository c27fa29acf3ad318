"""Pairs of a frame whose hulls overlap, surface against surface, in one kernel: proved to cross, or not proved.

The search starts around the triangles that crossed in the last frame, and from the whole surfaces if that fails.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Flags, Ints, Pairs
from harness.kernel import kernel
from harness.narrowphase.crossing import DEPTH, find_crossing
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.placement import Placement, pose_of
from harness.narrowphase.triangle_tree import TriangleTree, triangle_tree
from harness.scene.mesh import Mesh

# How many levels above the triangles that crossed the search starts, and for how many steps it looks there and from
# the root. With this start it takes a third less time than without.
LEVELS_UP = 3
NEARBY_STEPS = 100
STEPS = 1500


class MeshPairs:
    """Proofs that bodies with the same surface, in any sizes, touch.

    Parameters
    ----------
    mesh : Mesh
    """

    def __init__(self, mesh: Mesh) -> None:
        self._tree = triangle_tree(mesh.vertices, mesh.faces)
        self._stack = np.empty((DEPTH, 2), np.int64)
        self._last, self._now = np.empty((0, 3), np.int64), np.empty((0, 3), np.int64)
        self._remembered = 0

    def cross(self, pairs: Pairs, placement: Placement) -> Flags:
        """Which surfaces are proved to touch.

        Parameters
        ----------
        pairs : (k, 2) int array, sorted
        placement : Placement

        Returns
        -------
        (k,) bool array
            False proves nothing.
        """
        if len(pairs) > len(self._now):
            self._now = np.empty((len(pairs) + len(pairs) // 2, 3), np.int64)
        found = np.empty(len(pairs), np.bool_)
        last = self._last[: self._remembered]
        self._remembered = cross(pairs, placement, self._tree, self._stack, last, self._now, found)
        self._last, self._now = self._now, self._last
        return found


@kernel
def cross(
    pairs: Pairs, placement: Placement, tree: TriangleTree, stack: Ints, last: Ints, now: Ints, found: Flags
) -> int:
    """Look for a crossing of each pair.

    Parameters
    ----------
    pairs, placement : as `MeshPairs.cross` has them
    stack : (DEPTH, 2) written
    last : (l, 3) int array, i << 32 | j ascending and the leaves that crossed in the last frame
    now : the same of this frame, written
    found : (k,) written

    Returns
    -------
    How many were found.
    """
    place, count = 0, 0
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        key = i << 32 | j
        pose = pose_of(placement, i, j)
        margin = MARGIN * (pose.size_a + pose.size_b)
        while place < len(last) and last[place, 0] < key:
            place += 1
        a, b = -1, -1
        if place < len(last) and last[place, 0] == key:
            a, b = last[place, 1], last[place, 2]
            for _ in range(LEVELS_UP):
                a, b = tree.parent[a], tree.parent[b]
            a, b = find_crossing(tree, tree, pose, a, b, margin, NEARBY_STEPS, stack)
        if a < 0:
            a, b = find_crossing(tree, tree, pose, 0, 0, margin, STEPS, stack)
        found[k] = a >= 0
        if a >= 0:
            now[count, 0], now[count, 1], now[count, 2] = key, a, b
            count += 1
    return count
