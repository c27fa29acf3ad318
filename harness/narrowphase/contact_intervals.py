"""When two bodies that pass through each other touch: all intervals of a window, for hulls and for surfaces.

A contact begins with a time of impact. From then on it is followed: while the bodies are in each other, as long as
that certainly lasts; while the gap is within the tolerance, as long as it takes points to move by what is left of it.
It ends when the gap is seen to be wider than that.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.kernel import kernel
from harness.narrowphase.advancement import IMPACT, NEVER, STALLED, Motion, orientation, place, seen_at, time_of_impact
from harness.narrowphase.crossing import DEPTH
from harness.narrowphase.gjk import MARGIN, NO_SEEDS, OVERLAP, hull_distance, relative_pose
from harness.narrowphase.lasting_contact import lasting_crossing, overlap_lasts
from harness.narrowphase.mesh_advancement import NO_START, MeshShape, time_of_mesh_impact
from harness.narrowphase.support import SupportMap
from harness.narrowphase.surface_distance import surface_distance
from harness.narrowphase.vectors import dot, minus, scaled

PARTED = 1

# Looks at a contact after which following it is given up. Ordinary ones end after 50 to 200.
MOST_LOOKS = 20_000
# Searches for the next contact that are taken up again where they were given up, of a window.
MOST_RESUMED = 50
# Of the tolerance: the gap at which a contact ends, a little more than the one at which the next begins, and how far
# bodies may move between two looks though nothing proves that they touch.
PARTED_GAP, RESOLUTION = 1.125, 0.125
# How many levels above the triangles that crossed the next crossing is sought first, and for how many steps.
LEVELS_UP = 4
NEARBY_STEPS = 200
STEPS = 100_000
# Of the time for which the last crossing lasted: the next one is to last as long, if one can be found.
LESS = 0.5


class Parting(NamedTuple):
    """How a contact goes on.

    Attributes
    ----------
    verdict : PARTED; NEVER, if it lasts until the end of the window; STALLED, if following it was given up
    time : s, up to which it has been followed: of the parting, the end of the window, or where it was given up
    looks : how often the bodies were looked at
    """

    verdict: int
    time: float
    looks: int


class Contacts(NamedTuple):
    """All contacts of a window.

    Attributes
    ----------
    intervals : (k, 2) float array, s, when each begins and ends; ascending, apart, and within the window
    stalled : whether a search was given up at the end of the last one; nothing is known of what is after it
    """

    intervals: Floats
    stalled: bool


@kernel
def hull_contacts(
    hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Contacts:
    """All times in a window at which two hulls touch.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    a, b : Motion
    begin, end : s, the window
    tolerance : m, the gap at which hulls count as touching

    Returns
    -------
    Contacts
        That hold every instant at which the hulls overlap. Where a contact begins, the gap is between a quarter of
        the tolerance and all of it, unless the window begins there; where it ends, it is between 9/8 and 5/4
        of it. Contacts between which the gap is never wider than 9/8 of the tolerance are one, and so may be those
        between which it is no wider than 5/4. Some may be of hulls that only come within the tolerance.
    """
    intervals, count, time = np.empty((4, 2)), 0, begin
    while time < end:
        found = time_of_impact(hull_a, hull_b, a, b, time, end, tolerance, NO_SEEDS)
        if found.verdict != IMPACT:
            return Contacts(intervals[:count].copy(), found.verdict == STALLED)
        parting = end_of_hull_contact(hull_a, hull_b, a, b, found.time, end, tolerance)
        intervals = with_room(intervals, count)
        intervals[count, 0], intervals[count, 1] = found.time, parting.time
        count += 1
        if parting.verdict == STALLED or not parting.time > time:
            return Contacts(intervals[:count].copy(), True)
        time = parting.time
    return Contacts(intervals[:count].copy(), False)


@kernel
def mesh_contacts(
    shape_a: MeshShape, shape_b: MeshShape, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Contacts:
    """All times in a window at which two surfaces touch; one inside the other does not.

    Parameters and answer as for `hull_contacts`, with `MeshShape` for hulls.
    """
    intervals, count, time, resumed = np.empty((4, 2)), 0, begin, 0
    while time < end:
        found = time_of_mesh_impact(shape_a, shape_b, a, b, time, end, tolerance, NO_START)
        if found.verdict == STALLED and found.time > time and resumed < MOST_RESUMED:
            time = found.time  # nothing touches before: one of them inside the other and spinning fast
            resumed += 1
            continue
        if found.verdict != IMPACT:
            return Contacts(intervals[:count].copy(), found.verdict == STALLED)
        parting = end_of_mesh_contact(shape_a, shape_b, a, b, found.time, end, tolerance)
        intervals = with_room(intervals, count)
        intervals[count, 0], intervals[count, 1] = found.time, parting.time
        count += 1
        if parting.verdict == STALLED or not parting.time > time:
            return Contacts(intervals[:count].copy(), True)
        time = parting.time
    return Contacts(intervals[:count].copy(), False)


@kernel
def end_of_hull_contact(
    hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Parting:
    """When two hulls that touch at the beginning of a window part.

    Parameters as for `hull_contacts`.

    Returns
    -------
    Parting
        Until its time the gap was never wider than 5/4 of the tolerance; if they parted, it is wider than 9/8 then.
    """
    margin = MARGIN * (a.size + b.size)
    near = PARTED_GAP * max(tolerance, 8.0 * margin)
    a, b = seen_at(a, b, begin)
    speed, rest, now, seeds = fastest_passing(a, b), end - begin, 0.0, NO_SEEDS
    for look in range(1, MOST_LOOKS + 1):
        turn = orientation(a, now)
        pose = relative_pose(turn, a.size, orientation(b, now), b.size, place(b, now))
        found = hull_distance(hull_a, hull_b, pose, seeds, scaled(pose.offset, -1.0), margin, np.inf)
        seeds = found.seeds
        if found.verdict == OVERLAP:
            wait, seeds = overlap_lasts(hull_a, hull_b, pose, turn, a, b, seeds)
            left = near
        else:
            wait, left = 0.0, near - found.lower
        if left < 0.0:
            return Parting(PARTED, begin + now, look)
        wait = max(wait, max(left, RESOLUTION / PARTED_GAP * near) / speed)
        if now + wait >= rest:
            return Parting(NEVER, end, look)
        if not now + wait > now:
            return Parting(STALLED, begin + now, look)
        now += wait
    return Parting(STALLED, begin + now, MOST_LOOKS)


@kernel
def end_of_mesh_contact(
    shape_a: MeshShape, shape_b: MeshShape, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Parting:
    """When two surfaces that touch at the beginning of a window part.

    Parameters as for `mesh_contacts`.

    Returns
    -------
    Parting
        Until its time the gap was never wider than 5/4 of the tolerance; if they parted, it is wider than 9/8 then.
    """
    margin = MARGIN * (a.size + b.size)
    near = PARTED_GAP * max(tolerance, 8.0 * margin)
    tree_a, tree_b, stack = shape_a.tree, shape_b.tree, np.empty((DEPTH, 2), np.int64)
    a, b = seen_at(a, b, begin)
    speed, rest, now, start, enough = fastest_passing(a, b), end - begin, 0.0, (0, 0), 0.0
    for look in range(1, MOST_LOOKS + 1):
        turn = orientation(a, now)
        pose = relative_pose(turn, a.size, orientation(b, now), b.size, place(b, now))
        for _ in range(LEVELS_UP):
            start = tree_a.parent[start[0]], tree_b.parent[start[1]]
        wait, leaves = lasting_crossing(tree_a, tree_b, pose, turn, a, b, start, enough, NEARBY_STEPS, stack)
        if wait < enough:
            others, found = lasting_crossing(tree_a, tree_b, pose, turn, a, b, (0, 0), enough, STEPS, stack)
            if others > wait or leaves[0] < 0:
                wait, leaves = others, found
        left, enough = near, LESS * wait
        if leaves[0] < 0:
            gap, one, other = surface_distance(tree_a, tree_b, pose, near, margin, stack)
            if gap == np.inf:
                return Parting(PARTED, begin + now, look)
            left, leaves = near - gap, (one, other)
        start = leaves
        wait = max(wait, max(left, RESOLUTION / PARTED_GAP * near) / speed)
        if now + wait >= rest:
            return Parting(NEVER, end, look)
        if not now + wait > now:
            return Parting(STALLED, begin + now, look)
        now += wait
    return Parting(STALLED, begin + now, MOST_LOOKS)


@kernel
def fastest_passing(a: Motion, b: Motion) -> float:
    """At most how fast a point of one body passes one of the other, m/s."""
    drift = minus(b.velocity, a.velocity)
    return sqrt(dot(drift, drift)) + sqrt(dot(a.spin, a.spin)) * a.reach + sqrt(dot(b.spin, b.spin)) * b.reach


@kernel
def with_room(intervals: Floats, count: int) -> Floats:
    """The same, longer if full."""
    if count < len(intervals):
        return intervals
    longer = np.empty((2 * count, 2))
    for k in range(count):
        longer[k, 0], longer[k, 1] = intervals[k, 0], intervals[k, 1]
    return longer
