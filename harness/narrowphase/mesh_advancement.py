"""Conservative advancement of surfaces, convex or not: when two bodies of triangles in free flight touch.

Each pair of parts, a node of either tree of discs, has a clock of its own: the time until which it is proved not to
touch. The pair whose clock is earliest is looked at next, where the bodies are then: parts are replaced by their
halves, and triangles advanced by what their distance allows. Nothing touches before the earliest clock; it shows the
time of impact when it is that of two triangles a tolerance apart, and that nothing touches when none is left. A bound
proves this for every pair of parts by itself, so that ribs and hollows need no rule of their own.

The hulls go first: while they do not touch, nothing inside them does. Then the surfaces are searched in windows of time
in which few of their triangles can touch, which most contacts are found in, and in which most bodies that have just
parted are seen to leave each other's hollows; only then through the trees.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.advancement import time_of_impact
from harness.narrowphase.clearance_field import ClearanceField, clearance_field, no_field
from harness.narrowphase.free_flight import Motion, place, seen_at
from harness.narrowphase.gjk import COLD_START, LEAST_GAP, MARGIN, WarmStart
from harness.narrowphase.hulls_apart import apart_again
from harness.narrowphase.motion_bounds import (
    Flight,
    Instant,
    flight_of,
    instant_of,
    moving_disc_a,
    moving_disc_b,
    triangle_of,
    until_discs_touch,
    until_triangles_touch,
)
from harness.narrowphase.node_queue import drop_earliest, earliest, enqueue, larger, node_queue
from harness.narrowphase.slab_advancement import MOST_WINDOWS, empty_cap, empty_pairs, near_leaves, slab_of
from harness.narrowphase.spheres import passage
from harness.narrowphase.support import SupportMap, support_map
from harness.narrowphase.tree_pairs import DEPTH, NO_NODES, NodePair, Trees, halves, push_near
from harness.narrowphase.triangle_distance import triangle_distance
from harness.narrowphase.triangle_tree import TriangleTree, triangle_tree
from harness.narrowphase.vectors import Triangle, Vector, cross, dot, minus, plus, scaled, unit
from harness.narrowphase.verdicts import SearchVerdict
from harness.scene.mesh import Mesh

# Pairs of parts looked at, after which a search is given up where it stands. Ordinary ones take 100 to 1000.
MOST_STEPS = 200_000

# Of the aim of a search: a gap that is as good.
AT_AIM = 1.001

# Of the sum of the sizes: how near the hulls need be brought before the surfaces are searched.
HULL_TOLERANCE = 1e-3
# By how much points may turn faster than the centres approach before hulls are brought nearer than that: the search of
# the surfaces takes as many steps a turn, however slowly they approach.
SLOW = 1000.0

# Intervals in which hulls overlap that are searched one by one; what comes after is searched as one.
MOST_INTERVALS = 4


class MeshShape(NamedTuple):
    """A surface of diameter 1, as searches see it.

    Attributes
    ----------
    hull : SupportMap of its convex hull
    tree : TriangleTree
    radius : of a sphere around the centre that holds it
    field : ClearanceField of the surface, of no nodes where contacts are not followed; it only saves time
    """

    hull: SupportMap
    tree: TriangleTree
    radius: float
    field: ClearanceField


class MeshWarmStart(NamedTuple):
    """Where to begin the next search of a pair; it only saves time.

    Attributes
    ----------
    hulls : WarmStart of the search on the hulls
    leaves : of either tree, that of the nearest triangles; -1 if not known
    """

    hulls: WarmStart
    leaves: NodePair


MESH_COLD_START = MeshWarmStart(COLD_START, NO_NODES)


class MeshImpact(NamedTuple):
    """What a search has found.

    Attributes
    ----------
    verdict : SearchVerdict of an impact
    time : s, before which nothing touches; of the impact, if there is one, else the end of the window or inf
    gap : m, between the nearest triangles at an impact; else of no meaning
    axis : of the gap, pointing away from the second body, in the world: a unit vector, of no meaning if they cross
    warm_start : for the next search of this pair
    steps : pairs of parts looked at, and distances of hulls measured
    """

    verdict: SearchVerdict
    time: float
    gap: float
    axis: Vector
    warm_start: MeshWarmStart
    steps: int


class FirstTouch(NamedTuple):
    """What a search of two trees has found: as `MeshImpact`, with the leaves of the nearest triangles."""

    verdict: SearchVerdict
    time: float
    gap: float
    axis: Vector
    leaves: NodePair
    steps: int


class TriangleImpact(NamedTuple):
    """What a search on one pair of triangles has found: as `Impact`."""

    verdict: SearchVerdict
    time: float
    gap: float
    axis: Vector
    steps: int


def mesh_shape(mesh: Mesh, *, followed: bool = False) -> MeshShape:
    """The surface and the hull of a mesh, made ready for searches, and for following contacts fast where asked for."""
    radius = float(np.sqrt(np.square(mesh.vertices).sum(axis=1).max()))
    field = clearance_field(mesh) if followed else no_field()
    return MeshShape(support_map(mesh.hull.vertices), triangle_tree(mesh.vertices, mesh.faces), radius, field)


@kernel
def time_of_mesh_impact(
    shape_a: MeshShape,
    shape_b: MeshShape,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    start: MeshWarmStart,
) -> MeshImpact:
    """When two surfaces come within a tolerance of each other.

    Parameters
    ----------
    shape_a, shape_b : MeshShape
    a, b : Motion
    begin, end : s, the window; the end may be inf
    tolerance : m, the gap at which surfaces count as touching; LEAST_GAP of the sizes counts, if it is less
    start : MeshWarmStart of an earlier search for this pair, or MESH_COLD_START

    Returns
    -------
    MeshImpact
        At a time not after the true first contact, and at which the surfaces are no farther apart than the tolerance.
        Of surfaces that cross at the beginning, at the beginning. A surface wholly inside the other does not touch it.
        Surfaces that come within the tolerance, but do not touch, may be found to or not.
    """
    margin = MARGIN * (a.size + b.size)
    reach = a.size * shape_a.radius + b.size * shape_b.radius + max(tolerance, margin)
    # times from here on are relative to where the spheres around the bodies first touch, so that no digit is lost
    spheres = passage(minus(place(b, begin), place(a, begin)), minus(b.velocity, a.velocity), reach)
    entry = max(spheres.enter, 0.0)
    never = np.inf if begin + spheres.leave < end else end
    rest = min(spheres.leave, end - begin) - entry
    if not rest >= 0.0:
        return MeshImpact(SearchVerdict.NEVER, never, 0.0, (0.0, 0.0, 0.0), start, 0)
    a, b = seen_at(a, b, begin + entry)
    coarse = max(tolerance, hull_tolerance(a, b))
    hulls = time_of_impact(shape_a.hull, shape_b.hull, a, b, 0.0, rest, coarse, start.hulls)
    if hulls.verdict == SearchVerdict.NEVER:
        never = max(never, hulls.time)  # which is inf if they never do
        after = MeshWarmStart(hulls.warm_start, start.leaves)
        return MeshImpact(SearchVerdict.NEVER, never, 0.0, hulls.axis, after, hulls.steps)
    trees, steps = Trees(shape_a.tree, shape_b.tree), hulls.steps
    found = FirstTouch(SearchVerdict.STALLED, hulls.time, 0.0, hulls.axis, NO_NODES, 0)
    for interval in range(MOST_INTERVALS):
        # of hulls that overlap, the way from centre to centre is as good a guess as any
        axis = hulls.axis if hulls.gap > 0.0 else unit(minus(place(a, hulls.time), place(b, hulls.time)))
        found = touch_in_slabs(shape_a.hull, shape_b.hull, trees, a, b, hulls.time, rest, tolerance, axis)
        steps += found.steps
        if found.verdict != SearchVerdict.STALLED:
            break
        now = found.time
        until = rest
        if interval + 1 < MOST_INTERVALS:
            until = apart_again(shape_a.hull, shape_b.hull, a, b, now, rest, coarse, hulls.warm_start)
        found = first_touch(trees, a, b, now, until, tolerance, start.leaves)
        steps += found.steps
        if found.verdict != SearchVerdict.NEVER or not until < rest:
            break
        hulls = time_of_impact(shape_a.hull, shape_b.hull, a, b, until, rest, coarse, hulls.warm_start)
        steps += hulls.steps
        if hulls.verdict == SearchVerdict.NEVER:
            never = max(never, hulls.time)
            break
    time = never if found.verdict == SearchVerdict.NEVER else min(end, begin + (entry + found.time))
    after = MeshWarmStart(hulls.warm_start, found.leaves)
    return MeshImpact(found.verdict, time, found.gap, found.axis, after, steps)


@kernel
def hull_tolerance(a: Motion, b: Motion) -> float:
    """How near the hulls are brought before the surfaces are searched, m."""
    drift = minus(b.velocity, a.velocity)
    turning = sqrt(dot(a.spin, a.spin)) * a.reach + sqrt(dot(b.spin, b.spin)) * b.reach
    share = SLOW * sqrt(dot(drift, drift)) / turning if turning > 0.0 else 1.0
    return HULL_TOLERANCE * min(1.0, share) * (a.size + b.size)


@kernel
def touch_in_slabs(
    hull_a: SupportMap,
    hull_b: SupportMap,
    trees: Trees,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    axis: Vector,
) -> FirstTouch:
    """Search window after window, while few triangles can touch in each; STALLED from when on that is no longer so."""
    near = max(tolerance, LEAST_GAP * (a.size + b.size))
    flight = flight_of(a, b, near / 4.0)
    now, steps = begin, 0
    cap_a, cap_b, pairs = empty_cap(), empty_cap(), empty_pairs()
    for _ in range(MOST_WINDOWS):
        at = instant_of(flight, now)
        slab = slab_of(hull_a, hull_b, trees, at, axis, end - now, cap_a, cap_b)
        count = near_leaves(trees, at, slab, cap_a, cap_b, pairs) if min(slab.count_a, slab.count_b) >= 0 else -1
        if count < 0:
            break
        first = FirstTouch(SearchVerdict.NEVER, min(end, now + slab.length), 0.0, axis, NO_NODES, steps)
        for k in range(count):
            if now + pairs.waits[k] >= first.time:
                continue
            leaves = NodePair(pairs.leaves[k, 0], pairs.leaves[k, 1])
            if certainly_apart(trees, leaves, at, first.axis, first.time - now):
                continue
            found = impact_of_triangles(trees, leaves, flight, now, first.time, near)
            steps += found.steps
            if found.verdict == SearchVerdict.STALLED:
                return FirstTouch(found.verdict, now, found.gap, found.axis, leaves, steps)
            if found.verdict == SearchVerdict.FOUND:
                first = FirstTouch(found.verdict, found.time, found.gap, found.axis, leaves, steps)
        steps += 1
        if first.verdict == SearchVerdict.FOUND or not first.time < end:
            return FirstTouch(first.verdict, first.time, first.gap, first.axis, first.leaves, steps)
        now = first.time
    return FirstTouch(SearchVerdict.STALLED, now, 0.0, axis, NO_NODES, steps)


@kernel
def first_touch(
    trees: Trees, a: Motion, b: Motion, begin: float, end: float, tolerance: float, leaves: NodePair
) -> FirstTouch:
    """Search the trees of two bodies as `seen_at` gives them; the leaves are those to look at first, if known."""
    near = max(tolerance, LEAST_GAP * (a.size + b.size))
    # Steps end a little before contact, where the axis of the gap can still be told from rounding.
    flight = flight_of(a, b, near / 4.0)
    stack, queue = np.empty((DEPTH, 2), np.int64), node_queue()
    verdict, until, gap, axis = SearchVerdict.NEVER, end, 0.0, (0.0, 0.0, 0.0)
    waiting, steps = enqueue(queue, 0, begin, NodePair(0, 0)), 0
    if leaves.a >= 0:
        likely = impact_of_triangles(trees, leaves, flight, begin, until, near)
        steps += likely.steps
        if likely.verdict == SearchVerdict.FOUND:
            verdict, until, gap, axis = likely.verdict, likely.time, likely.gap, likely.axis
    while waiting > 0 and queue.times[0] < until:
        now = queue.times[0]
        stack[0, 0], stack[0, 1] = earliest(queue)
        waiting, height = drop_earliest(queue, waiting), 1
        at = instant_of(flight, now)
        while height > 0:
            if steps >= MOST_STEPS:
                return FirstTouch(SearchVerdict.STALLED, now, gap, axis, leaves, steps)
            steps += 1
            height -= 1
            nodes = NodePair(stack[height, 0], stack[height, 1])
            if trees.a.right[nodes.a] < 0 and trees.b.right[nodes.b] < 0:
                found = impact_of_triangles(trees, nodes, flight, now, until, near)
                steps += found.steps
                if found.verdict == SearchVerdict.STALLED:
                    return FirstTouch(found.verdict, now, found.gap, found.axis, nodes, steps)
                if found.verdict == SearchVerdict.FOUND:
                    verdict, until, gap, axis, leaves = found.verdict, found.time, found.gap, found.axis, nodes
                    if until <= now:
                        return FirstTouch(verdict, until, gap, axis, leaves, steps)
                continue
            parts = halves(trees, nodes, at, until - now, moving_disc_a, moving_disc_b, until_discs_touch)
            height = push_near(stack, height, parts)
            if waiting + 2 > len(queue.times):
                queue = larger(queue, waiting)
            if 0.0 < parts.second_wait < np.inf:
                waiting = enqueue(queue, waiting, now + parts.second_wait, parts.second)
            if 0.0 < parts.first_wait < np.inf:
                waiting = enqueue(queue, waiting, now + parts.first_wait, parts.first)
    return FirstTouch(verdict, until, gap, axis, leaves, steps)


@kernel
def certainly_apart(trees: Trees, leaves: NodePair, at: Instant, axis: Vector, horizon: float) -> bool:
    """Whether triangles stay apart up to a horizon (s) along an axis, or along the normal of either.

    That takes a third of the time of measuring their distance. The axis is best that of a contact nearby, along which
    most of what is around it is apart.
    """
    one, other = triangles_of(trees, leaves, at)
    if until_triangles_touch(one, other, axis, at, horizon) == np.inf:
        return True
    for side in range(2):
        face = one if side == 0 else other
        normal = unit(cross(minus(face[1], face[0]), minus(face[2], face[0])))
        if dot(normal, minus(one[0], other[0])) < 0.0:
            normal = scaled(normal, -1.0)
        if until_triangles_touch(one, other, normal, at, horizon) == np.inf:
            return True
    return False


@strict_step
def triangles_of(trees: Trees, leaves: NodePair, at: Instant) -> tuple[Triangle, Triangle]:
    """Of two leaves, where the bodies are at an instant, from the centre of a, m."""
    one = triangle_of(trees.a, -1 - trees.a.right[leaves.a], at.turn_a, at.size_a)
    arms = triangle_of(trees.b, -1 - trees.b.right[leaves.b], at.turn_b, at.size_b)
    return one, (plus(at.offset, arms[0]), plus(at.offset, arms[1]), plus(at.offset, arms[2]))


@kernel
def impact_of_triangles(
    trees: Trees, leaves: NodePair, flight: Flight, begin: float, end: float, near: float
) -> TriangleImpact:
    """When the triangles of two leaves come within a gap of `near` (m).

    The search goes on to the aim, a quarter of that, so that the time is the same from wherever it begins. Triangles
    that come within the gap, but not to the aim, are not found.
    """
    a, b = flight.a, flight.b
    margin = MARGIN * (a.size + b.size)
    now = begin
    for step in range(1, MOST_STEPS):
        at = instant_of(flight, now)
        one, other = triangles_of(trees, leaves, at)
        found = triangle_distance(one, other, margin)
        if found.upper <= AT_AIM * flight.aim or found.lower <= margin:
            return TriangleImpact(SearchVerdict.FOUND, now, found.upper, found.axis, step)
        wait = until_triangles_touch(one, other, found.axis, at, end - now)
        if wait == np.inf:
            return TriangleImpact(SearchVerdict.NEVER, end, found.upper, found.axis, step)
        if not now + wait > now:
            verdict = SearchVerdict.FOUND if found.upper <= near else SearchVerdict.STALLED
            return TriangleImpact(verdict, now, found.upper, found.axis, step)
        now += wait
    return TriangleImpact(SearchVerdict.STALLED, now, 0.0, (0.0, 0.0, 0.0), MOST_STEPS)
