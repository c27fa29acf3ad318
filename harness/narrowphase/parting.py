"""Until when two bodies that touch go on touching: conservative advancement, the other way round.

Bodies that stay in touch when any of their points is displaced by less than some depth do so for that depth over the
speed at which their points can approach or leave each other. Hulls are that deep in each other if they still overlap
when both are shrunk by it; surfaces, if an edge of one goes that far through a triangle of the other.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from harness.arrays import Ints
from harness.kernel import kernel
from harness.narrowphase.advancement import IMPACT, MOST_STEPS, NEVER, STALLED, Impact, Motion, orientation, place
from harness.narrowphase.crossing import CROSSING, DEPTH, find_crossing
from harness.narrowphase.gjk import MARGIN, NO_SEEDS, OVERLAP, Relative, Seeds, hull_distance, relative_pose
from harness.narrowphase.mesh_advancement import MeshImpact, MeshShape, Start, time_of_mesh_impact
from harness.narrowphase.mesh_pairs import LEVELS_UP, NEARBY_STEPS, STEPS
from harness.narrowphase.support import SupportMap
from harness.narrowphase.vectors import dot, minus, scaled

# How much both hulls are shrunk at most.
MOST_SHRUNK = 0.9
# How far an edge is first hoped to reach through a triangle, of the sum of the sizes; how much farther than the last
# time; and how often less is tried around the last place.
FIRST_DEPTH, DEEPER, TRIES_NEARBY = 0.01, 1.5, 4


@kernel
def time_of_parting(
    hull: SupportMap, inradius: float, a: Motion, b: Motion, begin: float, end: float, tolerance: float, seeds: Seeds
) -> Impact:
    """When two bodies of one hull that touch at the beginning are farther than a tolerance apart.

    Parameters
    ----------
    hull : SupportMap
    inradius : of a sphere around the centre that the hull of size 1 holds
    a, b, begin, end, seeds : as for `time_of_impact`
    tolerance : m; gaps below are contact. Above 0, since partings into a smaller gap cannot be told

    Returns
    -------
    Impact
        With the verdict IMPACT at a time at which they are apart, and before which they always touch.
    """
    margin = MARGIN * (a.size + b.size)
    least = max(tolerance, 2.0 * margin)
    speed = leaving(a, b)
    time, shrunk = begin, 0.5
    for step in range(1, MOST_STEPS + 1):
        turn_a, turn_b = orientation(a, time), orientation(b, time)
        offset = minus(place(b, time), place(a, time))
        depth = 0.0
        while depth == 0.0 and shrunk * inradius * (a.size + b.size) > least:
            rest = 1.0 - shrunk
            pose = relative_pose(turn_a, rest * a.size, turn_b, rest * b.size, offset)
            inner = hull_distance(hull, hull, pose, NO_SEEDS, scaled(pose.offset, -1.0), margin, margin)
            if inner.verdict == OVERLAP:
                depth = shrunk * inradius * (a.size + b.size)
            else:
                shrunk *= 0.5
        shrunk = min(2.0 * shrunk, MOST_SHRUNK)
        if depth == 0.0:
            pose = relative_pose(turn_a, a.size, turn_b, b.size, offset)
            found = hull_distance(hull, hull, pose, seeds, scaled(pose.offset, -1.0), margin, np.inf)
            seeds = found.seeds
            if found.upper >= least:
                return Impact(IMPACT, time, found.upper, (0.0, 0.0, 0.0), seeds, step)
            depth = least - found.upper
        time += depth / speed
        if not time < end:
            return Impact(NEVER, end, 0.0, (0.0, 0.0, 0.0), seeds, step)
    return Impact(STALLED, time, 0.0, (0.0, 0.0, 0.0), seeds, MOST_STEPS)


@kernel
def time_of_mesh_parting(
    shape: MeshShape, a: Motion, b: Motion, begin: float, end: float, tolerance: float, start: Start
) -> MeshImpact:
    """When two bodies of one surface that touch at the beginning are farther than a tolerance apart.

    Parameters
    ----------
    shape : MeshShape
    a, b, begin, end, start : as for `time_of_mesh_impact`
    tolerance : m; gaps below are contact. Above 0, since partings into a smaller gap cannot be told

    Returns
    -------
    MeshImpact
        With the verdict IMPACT at a time at which they are apart; before, they are nowhere farther apart than twice the
        tolerance.
    """
    margin = MARGIN * (a.size + b.size)
    least = max(tolerance, 2.0 * margin)
    speed = leaving(a, b)
    stack = np.empty((DEPTH, 2), np.int64)
    nowhere = (0.0, 0.0, 0.0)
    time, depth, leaves = begin, FIRST_DEPTH * (a.size + b.size), start.leaves
    for step in range(1, MOST_STEPS + 1):
        offset = minus(place(b, time), place(a, time))
        pose = relative_pose(orientation(a, time), a.size, orientation(b, time), b.size, offset)
        depth, leaves = depth_of_crossing(shape, pose, depth, least, leaves, stack)
        if depth < least:
            near = time_of_mesh_impact(shape, shape, a, b, time, time + least / speed, least, start)
            if near.verdict == NEVER:
                return MeshImpact(IMPACT, time, least, nowhere, Start(start.seeds, leaves), step)
            depth = least
        time += depth / speed
        if not time < end:
            return MeshImpact(NEVER, end, 0.0, nowhere, Start(start.seeds, leaves), step)
        depth *= DEEPER
    return MeshImpact(STALLED, time, 0.0, nowhere, Start(start.seeds, leaves), MOST_STEPS)


@kernel
def depth_of_crossing(
    shape: MeshShape, pose: Relative, depth: float, least: float, leaves: tuple[int, int], stack: Ints
) -> tuple[float, tuple[int, int]]:
    """How far an edge reaches through a triangle, or somewhat less, and where; 0 if it is less than the least of note.

    It is looked for around the last such place, and then everywhere.
    """
    tree = shape.tree
    deep = depth
    if leaves[0] >= 0:
        around_a, around_b = leaves
        for _ in range(LEVELS_UP):
            around_a, around_b = tree.parent[around_a], tree.parent[around_b]
        for _ in range(TRIES_NEARBY):
            verdict, leaf_a, leaf_b = find_crossing(tree, tree, pose, around_a, around_b, deep, NEARBY_STEPS, stack)
            if verdict == CROSSING:
                return deep, (leaf_a, leaf_b)
            deep *= 0.5
    deep = depth
    while deep >= least:
        verdict, leaf_a, leaf_b = find_crossing(tree, tree, pose, 0, 0, deep, STEPS, stack)
        if verdict == CROSSING:
            return deep, (leaf_a, leaf_b)
        deep *= 0.25
    return 0.0, leaves


@kernel
def leaving(a: Motion, b: Motion) -> float:
    """How fast a point of one body can move as seen from a point of the other, m/s."""
    velocity = minus(b.velocity, a.velocity)
    return sqrt(dot(velocity, velocity)) + sqrt(dot(a.spin, a.spin)) * a.reach + sqrt(dot(b.spin, b.spin)) * b.reach
