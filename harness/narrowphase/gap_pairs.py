"""Gaps of all close pairs of a frame, of hulls or of surfaces, in one kernel.

Each pair starts from what it ended with in the last frame: the simplex of the hulls, the nearest triangles of the
surfaces. They are only guesses at where to look: the gap is proved anew from the poses at hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from harness.arrays import Ints, Pairs
from harness.kernel import kernel, strict_step
from harness.narrowphase.body_shapes import Hulls, hull_of, hulls_of_bodies
from harness.narrowphase.gap import Accuracy, Gap, hull_gap, mesh_gap, mesh_gap_shape
from harness.narrowphase.gap_shapes import GapShapes, gap_shape_of, gap_shapes_of_bodies
from harness.narrowphase.gjk import COLD_START, WarmStart
from harness.narrowphase.mesh_advancement import MeshWarmStart
from harness.narrowphase.placement import Placement, pose_of, rotation_of
from harness.narrowphase.pose_gaps import Gaps
from harness.narrowphase.support import support_map
from harness.narrowphase.surface_gap import SearchScratch, search_scratch
from harness.narrowphase.tree_pairs import NO_NODES, NodePair
from harness.narrowphase.vectors import scaled, turned
from harness.scene.hull import Hull
from harness.scene.mesh import Mesh


class GapMemory(NamedTuple):
    """What the pairs of a frame ended with.

    Attributes
    ----------
    keys : (k,) int array, i << 32 | j, ascending
    simplices : (k, 4) int array, of the hulls, as a WarmStart
    leaves : (k, 2) int array, of the nearest triangles; -1 for none
    """

    keys: Ints
    simplices: Ints
    leaves: Ints


class HullGapPairs:
    """Gaps of pairs of bodies that have these hulls, in any sizes.

    Parameters
    ----------
    hulls : of diameter 1, of each mesh
    mesh_of : (n,) int array, the number of each body's mesh
    """

    def __init__(self, hulls: Sequence[Hull], mesh_of: Ints) -> None:
        self._hulls = hulls_of_bodies([support_map(hull.vertices) for hull in hulls], mesh_of)
        self._last = gap_memory(0)

    def gaps(self, pairs: Pairs, placement: Placement, accuracy: Accuracy) -> Gaps:
        """The gaps of the pairs of a frame, m, and their nearest points, m, in the world.

        Parameters
        ----------
        pairs : (k, 2) int array, sorted
        placement : Placement
        accuracy : Accuracy, in the units of the placement
        """
        now, found = gap_memory(len(pairs)), gaps_of(len(pairs))
        hull_pair_gaps(pairs, placement, accuracy, self._hulls, self._last, now, found)
        self._last = now
        return found


class MeshGapPairs:
    """Gaps of pairs of bodies that have these surfaces, in any sizes.

    Parameters
    ----------
    meshes : that there are
    mesh_of : (n,) int array, the number of each body's mesh
    """

    def __init__(self, meshes: Sequence[Mesh], mesh_of: Ints) -> None:
        self._shapes = gap_shapes_of_bodies([mesh_gap_shape(mesh) for mesh in meshes], mesh_of)
        self._last, self._scratch = gap_memory(0), search_scratch()

    def gaps(self, pairs: Pairs, placement: Placement, accuracy: Accuracy) -> Gaps:
        """The gaps of the pairs of a frame; parameters and answer as for `HullGapPairs.gaps`."""
        now, found = gap_memory(len(pairs)), gaps_of(len(pairs))
        mesh_pair_gaps(pairs, placement, accuracy, self._shapes, self._scratch, self._last, now, found)
        self._last = now
        return found


def gap_memory(capacity: int) -> GapMemory:
    """Uninitialised."""
    return GapMemory(np.empty(capacity, np.int64), np.empty((capacity, 4), np.int64), np.empty((capacity, 2), np.int64))


def gaps_of(count: int) -> Gaps:
    """Uninitialised."""
    return Gaps(np.empty(count), np.empty((count, 2, 3)))


@kernel
def hull_pair_gaps(
    pairs: Pairs,
    placement: Placement,
    accuracy: Accuracy,
    hulls: Hulls,
    last: GapMemory,
    now: GapMemory,
    found: Gaps,
) -> None:
    """The gap of each pair, written to `found`, and how it ended, to `now`."""
    place = 0
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        place = remembered(last, place, i << 32 | j)
        pose = pose_of(placement, i, j)
        start = simplex_of(last, place, i << 32 | j)
        gap, _, start = hull_gap(hull_of(hulls, i), hull_of(hulls, j), pose, start, scaled(pose.offset, -1.0), accuracy)
        remember(now, k, i << 32 | j, start, NO_NODES)
        write_gap(found, k, gap, placement, i)


@kernel
def mesh_pair_gaps(
    pairs: Pairs,
    placement: Placement,
    accuracy: Accuracy,
    shapes: GapShapes,
    scratch: SearchScratch,
    last: GapMemory,
    now: GapMemory,
    found: Gaps,
) -> None:
    """The gap of each pair, written to `found`, and how it ended, to `now`."""
    place = 0
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        place = remembered(last, place, i << 32 | j)
        leaves = NO_NODES
        if place < len(last.keys) and last.keys[place] == i << 32 | j:
            leaves = NodePair(last.leaves[place, 0], last.leaves[place, 1])
        start = MeshWarmStart(simplex_of(last, place, i << 32 | j), leaves)
        one, other = gap_shape_of(shapes, i), gap_shape_of(shapes, j)
        gap, start = mesh_gap(one, other, pose_of(placement, i, j), start, accuracy, scratch)
        remember(now, k, i << 32 | j, start.hulls, start.leaves)
        write_gap(found, k, gap, placement, i)


@strict_step
def remembered(last: GapMemory, place: int, key: int) -> int:
    """The place of the first key of the last frame, from a place on, that is not below one."""
    while place < len(last.keys) and last.keys[place] < key:
        place += 1
    return place


@strict_step
def simplex_of(last: GapMemory, place: int, key: int) -> WarmStart:
    """The simplex that is remembered at a place, if it is that of a key."""
    start = COLD_START
    if place < len(last.keys) and last.keys[place] == key:
        s = last.simplices
        start = s[place, 0], s[place, 1], s[place, 2], s[place, 3]
    return start


@strict_step
def remember(now: GapMemory, k: int, key: int, start: WarmStart, leaves: NodePair) -> None:
    now.keys[k] = key
    now.simplices[k, 0], now.simplices[k, 1], now.simplices[k, 2], now.simplices[k, 3] = start
    now.leaves[k, 0], now.leaves[k, 1] = leaves


@strict_step
def write_gap(found: Gaps, k: int, gap: Gap, placement: Placement, i: int) -> None:
    """Write a gap in m, and the points where they are in the world."""
    metre, turn, x = 1.0 / placement.scale, rotation_of(placement, i), placement.positions
    found.gaps[k] = gap.upper * metre
    point_a, point_b = turned(turn, scaled(gap.point_a, metre)), turned(turn, scaled(gap.point_b, metre))
    for axis in range(3):
        found.points[k, 0, axis] = x[i, axis] + point_a[axis]
        found.points[k, 1, axis] = x[i, axis] + point_b[axis]
