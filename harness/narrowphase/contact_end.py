"""Until when two bodies that touch go on touching, for hulls and for surfaces.

A contact is followed step by step: while the bodies are in each other, as long as that certainly lasts, as depth or a
crossing of triangles shows; while the gap is within the tolerance, as long as it takes points to move by what is left
of it. It ends when the gap is seen to be wider than that.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import NamedTuple, TypeVar

import numpy as np

from harness.arrays import Ints
from harness.kernel import inner, kernel
from harness.narrowphase.crossing_duration import longest_crossing
from harness.narrowphase.free_flight import Motion, RelativeMotion, fastest_passing, relative_motion, seen_at
from harness.narrowphase.gjk import COLD_START, LEAST_GAP, MARGIN, WarmStart, hull_distance
from harness.narrowphase.immersion_duration import immersion_lasts
from harness.narrowphase.mesh_advancement import MeshShape
from harness.narrowphase.nearness_duration import NO_WITNESSES, nearest_points, nearness_lasts
from harness.narrowphase.overlap_duration import overlap_lasts
from harness.narrowphase.simplex_nearness import stays_near
from harness.narrowphase.support import SupportMap
from harness.narrowphase.tree_pairs import DEPTH, ROOTS, NodePair, Trees
from harness.narrowphase.triangles_within import triangles_within
from harness.narrowphase.vectors import dot, scaled
from harness.narrowphase.verdicts import PairVerdict, SearchVerdict

Shape = TypeVar("Shape", SupportMap, MeshShape)
Memory = TypeVar("Memory")

# Steps after which following a contact is given up. Ordinary ones take 10 to 200.
MOST_STEPS = 20_000
# Of these, in a row, such as only the gap allows; an ordinary contact has 20, faces that slide over each other no end.
MOST_CREEPING = 2_000
# Of the tolerance: the gap at which a contact ends, a little more than the one at which the next begins, and how far
# bodies may move in a step though nothing proves that they touch.
ENDING_GAP, RESOLUTION = 1.125, 0.125
# How many levels above the triangles that crossed the next crossing is searched for first, and for how many steps there
# and from the roots. To search around more triangles where that one lasts less takes more time than the steps it saves.
LEVELS_UP = 2
NEARBY_STEPS = 100
STEPS = 100_000
# Of the time for which the last crossing lasted: the next one is to last as long, if one can be found. With .5, or with
# a search from higher up, following a contact takes longer.
LESS = 0.3
# Of the sum of the sizes: a distance. Where no crossing lasts longer than points take to move that far, at first and
# near the end of a contact, it is not worth asking how deep the bodies are in each other.
SHALLOW = 5e-4
# Where the bodies are held by their gap alone, after how many instants the whole surfaces are searched for a crossing.
SEARCH_EVERY = 8


class ContactEnd(NamedTuple):
    """How a contact goes on.

    Attributes
    ----------
    verdict : SearchVerdict of its end
    time : s, up to which it has been followed: its end, that of the window, or where it was given up
    steps : instants that were looked at
    holds : s, until when it certainly lasts; that may be beyond the end of the window
    """

    verdict: SearchVerdict
    time: float
    steps: int
    holds: float


class Hold(NamedTuple):
    """How firmly two bodies touch at an instant.

    Attributes
    ----------
    lasts : s, for which they certainly stay in each other; 0 where that is not proved
    near : s, for which they certainly stay near enough to each other; 0 where that is not proved
    slack : m, by which the gap may still widen; below 0 where it is too wide already
    """

    lasts: float
    near: float
    slack: float


class LastCrossing(NamedTuple):
    """What is remembered of two surfaces from one instant to the next.

    Attributes
    ----------
    leaves : of either tree, whose triangles crossed or were nearest; the roots at first
    enough : s, for which the next crossing is to last
    instants : how many in a row have shown no crossing that lasts
    stack : (DEPTH, 2) int array, written
    """

    leaves: NodePair
    enough: float
    instants: int
    stack: Ints


@kernel
def end_of_hull_contact(
    hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> ContactEnd:
    """When two hulls that touch at the beginning of a window come apart.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    a, b : Motion
    begin, end : s, the window; the end may be inf
    tolerance : m, the gap at which hulls count as touching

    Returns
    -------
    ContactEnd
        Until its time the gap was never wider than 5/4 of the tolerance; if the contact ends, it is wider than 9/8
        then.
    """
    found, _ = end_of_contact(hull_a, hull_b, a, b, begin, end, tolerance, hold_of_hulls, COLD_START)
    return found


@kernel
def end_of_mesh_contact(
    shape_a: MeshShape, shape_b: MeshShape, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> ContactEnd:
    """When two surfaces that touch at the beginning of a window come apart.

    Parameters and answer as for `end_of_hull_contact`, with `MeshShape` for hulls. A surface inside the other does not
    touch it.
    """
    last = LastCrossing(ROOTS, 0.0, 0, np.empty((DEPTH, 2), np.int64))
    found, _ = followed_mesh_contact(shape_a, shape_b, a, b, begin, end, tolerance, last)
    return found


@kernel
def followed_mesh_contact(
    shape_a: MeshShape,
    shape_b: MeshShape,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    last: LastCrossing,
) -> tuple[ContactEnd, LastCrossing]:
    """As `end_of_mesh_contact`, from what was remembered of the contact, with what to remember of it."""
    return end_of_contact(shape_a, shape_b, a, b, begin, end, tolerance, hold_of_surfaces, last)


@inner
def end_of_contact(
    shape_a: Shape,
    shape_b: Shape,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    hold_of: Callable[[Shape, Shape, RelativeMotion, float, Memory], tuple[Hold, Memory]],
    memory: Memory,
) -> tuple[ContactEnd, Memory]:
    """The end of a contact of hulls or surfaces, given what shows how firmly they touch."""
    near = ENDING_GAP * max(tolerance, LEAST_GAP * (a.size + b.size))
    a, b = seen_at(a, b, begin)
    speed, rest, now, creeping = fastest_passing(a, b), end - begin, 0.0, 0
    for step in range(1, MOST_STEPS + 1):
        hold, memory = hold_of(shape_a, shape_b, relative_motion(a, b, now), near, memory)
        if hold.slack < 0.0:
            return ContactEnd(SearchVerdict.FOUND, begin + now, step, begin + now), memory
        wait = max(max(hold.lasts, hold.near), max(hold.slack, RESOLUTION / ENDING_GAP * near) / speed)
        if now + wait >= rest:
            return ContactEnd(SearchVerdict.NEVER, end, step, max(end, begin + (now + hold.lasts))), memory
        creeping = 0 if hold.lasts > 0.0 else creeping + 1
        if not now + wait > now or creeping == MOST_CREEPING:
            return ContactEnd(SearchVerdict.STALLED, begin + now, step, begin + now), memory
        now += wait
    return ContactEnd(SearchVerdict.STALLED, begin + now, MOST_STEPS, begin + now), memory


@inner
def hold_of_hulls(
    hull_a: SupportMap, hull_b: SupportMap, seen: RelativeMotion, near: float, start: WarmStart
) -> tuple[Hold, WarmStart]:
    """How firmly two hulls touch, whose contact ends at a gap of `near`; and where to start next time."""
    pose = seen.pose
    margin = MARGIN * (pose.size_a + pose.size_b)
    found = hull_distance(hull_a, hull_b, pose, start, scaled(pose.offset, -1.0), margin, np.inf, 0.0)
    limit = near * (1.0 + RESOLUTION / ENDING_GAP)
    if found.verdict != PairVerdict.TOUCHING:
        flat = found.warm_start[3] < 0  # else rounding alone keeps a tetrahedron from showing an overlap
        lasts = stays_near(hull_a, hull_b, seen, found.warm_start, limit) if flat and found.lower <= near else 0.0
        return Hold(0.0, lasts, near - found.lower), found.warm_start
    overlap = overlap_lasts(hull_a, hull_b, seen, found.warm_start)
    lasts = stays_near(hull_a, hull_b, seen, overlap.face, limit) if overlap.depth < near else 0.0
    return Hold(overlap.lasts, lasts, near), overlap.warm_start


@inner
def hold_of_surfaces(
    shape_a: MeshShape, shape_b: MeshShape, seen: RelativeMotion, near: float, last: LastCrossing
) -> tuple[Hold, LastCrossing]:
    """How firmly two surfaces touch, whose contact ends at a gap of `near`; and where to start next time."""
    trees, pose, stack = Trees(shape_a.tree, shape_b.tree), seen.pose, last.stack
    reach_a, reach_b = shape_a.radius * pose.size_a, shape_b.radius * pose.size_b
    speed = sqrt(dot(seen.drift, seen.drift))
    speed += sqrt(dot(seen.spin_a, seen.spin_a)) * reach_a + sqrt(dot(seen.spin_b, seen.spin_b)) * reach_b
    at_first = last.enough == 0.0 and last.instants == 0
    if at_first or last.enough * speed > SHALLOW * (pose.size_a + pose.size_b):
        deep = immersion_lasts(shape_a.field, shape_b.field, reach_a, reach_b, seen)
        if deep > last.enough:  # near the end, where it is shorter, a crossing lasts longer
            return Hold(deep, 0.0, near), LastCrossing(last.leaves, LESS * deep, 0, stack)
    margin = MARGIN * (pose.size_a + pose.size_b)
    start = last.leaves
    for _ in range(LEVELS_UP):
        start = NodePair(trees.a.parent[start.a], trees.b.parent[start.b])
    found = longest_crossing(trees, seen, start, last.enough, NEARBY_STEPS, stack)
    points, gap, leaves = NO_WITNESSES, 0.0, found.leaves
    if leaves.a < 0:
        points, leaves = nearest_points(trees, pose, last.leaves, margin), last.leaves
        gap = points.gap
    if gap > near:  # a search for any triangles that are near is a search for any that cross as well
        gap, leaves = triangles_within(trees, pose, near, margin, stack)
        if gap > near:
            return Hold(0.0, 0.0, near - gap), last
        found = longest_crossing(trees, seen, leaves, 0.0, NEARBY_STEPS, stack)
        points = nearest_points(trees, pose, leaves, margin)
    # a crossing anywhere else may last longer; while the gap alone holds them, there mostly is none
    if not found.lasts > 0.0 and last.instants % SEARCH_EVERY == SEARCH_EVERY - 1:
        other = longest_crossing(trees, seen, ROOTS, last.enough, STEPS, stack)
        if other.leaves.a >= 0:
            found, gap, leaves = other, 0.0, other.leaves
    if found.lasts > 0.0:
        return Hold(found.lasts, 0.0, near), LastCrossing(leaves, LESS * found.lasts, 0, stack)
    lasts = nearness_lasts(points, seen, near * (1.0 + RESOLUTION / ENDING_GAP))
    return Hold(0.0, lasts, near - gap), LastCrossing(leaves, 0.0, last.instants + 1, stack)
