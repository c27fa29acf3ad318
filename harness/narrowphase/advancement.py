"""Conservative advancement: when two convex hulls in free flight touch, or a hull and a wall.

A gap along an axis cannot close faster than the bodies approach along it, and their points turn into it. So time may be
advanced by the gap over that speed without any risk of passing a contact, and again from there (Mirtich, 1996). A
bound of second order, from the speeds at which the points do move, takes longer steps: `open_for`. The first
bound holds because hulls are convex: where it is not positive they never touch. For concave bodies it proves nothing.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.free_flight import Motion, orientation, place, turning_speed
from harness.narrowphase.gjk import COLD_START, LEAST_GAP, MARGIN, WarmStart, hull_distance, relative_pose
from harness.narrowphase.revolution import apart_from_wall_until, apart_until
from harness.narrowphase.support import SupportMap, support
from harness.narrowphase.vectors import Matrix, Vector, cross, dot, minus, plus, scaled, turned, turned_back
from harness.narrowphase.verdicts import SearchVerdict

# Steps after which a search is given up where it stands. Ordinary ones take 2 to 50.
MOST_STEPS = 1000
# Steps from one look at what the bodies sweep to the next: a body that spins fast and approaches slowly takes so many.
STEPS_PER_SWEEP = 128
# Trials of the length of a step.
MOST_TRIALS = 3


class Impact(NamedTuple):
    """What a search has found.

    Attributes
    ----------
    verdict : SearchVerdict of an impact
    time : s, before which nothing touches; of the impact, if there is one, else the end of the window or inf
    gap : m, what was left of the gap at that time
    axis : of the gap, pointing away from the second body or the wall, in the world; a unit vector
    warm_start : for the next search of this pair
    steps : distances measured
    """

    verdict: SearchVerdict
    time: float
    gap: float
    axis: Vector
    warm_start: WarmStart
    steps: int


class TurnedHull(NamedTuple):
    """A hull at an instant.

    Attributes
    ----------
    hull : SupportMap
    body : Motion
    turn : from the axes of the body to those of the world
    """

    hull: SupportMap
    body: Motion
    turn: Matrix


class GapNow(NamedTuple):
    """Between two hulls at an instant.

    Attributes
    ----------
    axis : unit vector from b to a
    width : m
    drift : m/s, at which the centres approach along the axis
    arm_a, arm_b : m, from either centre to the point that is nearest now
    """

    axis: Vector
    width: float
    drift: float
    arm_a: Vector
    arm_b: Vector


@kernel
def time_of_impact(
    hull_a: SupportMap,
    hull_b: SupportMap,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    start: WarmStart,
) -> Impact:
    """When two hulls come within a tolerance of each other.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    a, b : Motion
    begin, end : s, the window; the end may be inf
    tolerance : m, the gap at which hulls count as touching; LEAST_GAP of the sizes counts, if it is less
    start : WarmStart of an earlier search for this pair, or COLD_START

    Returns
    -------
    Impact
        At a time not after the true first contact, and at which the hulls are no farther apart than the tolerance. Of
        hulls that overlap at the beginning, at the beginning.
    """
    margin = MARGIN * (a.size + b.size)
    near = max(tolerance, LEAST_GAP * (a.size + b.size))
    aim = near / 4.0  # a little before contact, where the axis of the gap can still be told from rounding
    time, axis, gap = begin, (0.0, 0.0, 0.0), 0.0
    for step in range(1, MOST_STEPS + 1):
        turn_a, turn_b = orientation(a, time), orientation(b, time)
        offset = minus(place(b, time), place(a, time))
        pose = relative_pose(turn_a, a.size, turn_b, b.size, offset)
        found = hull_distance(hull_a, hull_b, pose, start, scaled(pose.offset, -1.0), margin, np.inf, 0.0)
        start, gap = found.warm_start, found.upper
        length = sqrt(dot(found.axis, found.axis))
        if length > 0.0:
            axis = turned(turn_a, scaled(found.axis, 1.0 / length))
        if gap <= near or found.lower <= aim:
            return Impact(SearchVerdict.FOUND, time, gap, axis, start, step)
        drift = dot(axis, minus(b.velocity, a.velocity))
        closing = drift + turning_speed(axis, a) + turning_speed(axis, b)
        if closing <= 0.0:
            return Impact(SearchVerdict.NEVER, np.inf, gap, axis, start, step)
        width = found.lower - aim
        wait = width / closing
        if time + wait <= end:
            arm_a, arm_b = turned(turn_a, found.point_a), minus(turned(turn_a, found.point_b), offset)
            one, other = TurnedHull(hull_a, a, turn_a), TurnedHull(hull_b, b, turn_b)
            longer = open_for(one, other, GapNow(axis, width, drift, arm_a, arm_b))
            wait = longer if longer > wait else wait
        time += wait
        if step % STEPS_PER_SWEEP == 0:
            time = apart_until(hull_a, hull_b, a, b, time)
        if time > end:
            return Impact(SearchVerdict.NEVER, end, gap, axis, start, step)
    return Impact(SearchVerdict.STALLED, time, gap, axis, start, MOST_STEPS)


@kernel
def open_for(one: TurnedHull, other: TurnedHull, gap: GapNow) -> float:
    """How long a gap along an axis stays open, s, by what the hulls do at first and what their spins can change of it.

    A point at p from its centre moves along the axis n at p.(n x w), which changes by at most |n x w| |w x p| a second.
    So after t no point of a hull is farther along than its support function in the direction n + t (n x w) says, and
    t^2 / 2 times this bound. As a function of t the gap left is concave: open now and later, it is open between.
    """
    a, b, axis, width, drift = one.body, other.body, gap.axis, gap.width, gap.drift
    across_a, across_b = cross(axis, a.spin), cross(axis, b.spin)
    bend = sqrt(dot(across_a, across_a) * dot(a.spin, a.spin)) * a.reach
    bend += sqrt(dot(across_b, across_b) * dot(b.spin, b.spin)) * b.reach
    rate = dot(across_a, gap.arm_a) - dot(across_b, gap.arm_b) - drift
    if bend == 0.0:
        return 0.0  # the first bound is as good
    root = sqrt(rate * rate + 2.0 * bend * width)
    time = (rate + root) / bend if rate > 0.0 else 2.0 * width / (root - rate)
    at_begin = reach_towards(one, other, axis, axis)
    safe, left_safe, beyond, left_beyond = 0.0, width, time, 0.0
    for trial in range(MOST_TRIALS):
        forward_a, forward_b = plus(axis, scaled(across_a, time)), plus(axis, scaled(across_b, time))
        used = reach_towards(one, other, forward_a, forward_b) - at_begin
        left = width - used - time * (drift + 0.5 * bend * time)
        if left >= 0.0:
            safe, left_safe = time, left
            if trial == 0:
                return time
        else:
            beyond, left_beyond = time, left
        # the chord between them runs below the gap
        time = safe + (beyond - safe) * left_safe / (left_safe - left_beyond)
    return time


@strict_step
def reach_towards(one: TurnedHull, other: TurnedHull, axis_a: Vector, axis_b: Vector) -> float:
    """How far hull a reaches against an axis from its centre, and hull b along one, together, m."""
    hull_a, hull_b = one.hull, other.hull
    back_a, back_b = turned_back(one.turn, axis_a), turned_back(other.turn, axis_b)
    k, m = support(hull_a, -back_a[0], -back_a[1], -back_a[2]), support(hull_b, back_b[0], back_b[1], back_b[2])
    low = hull_a.vertices[k, 0], hull_a.vertices[k, 1], hull_a.vertices[k, 2]
    high = hull_b.vertices[m, 0], hull_b.vertices[m, 1], hull_b.vertices[m, 2]
    return other.body.size * dot(back_b, high) - one.body.size * dot(back_a, low)


@kernel
def time_of_wall_impact(
    hull: SupportMap, body: Motion, wall: int, half: float, begin: float, end: float, tolerance: float
) -> Impact:
    """When a hull comes within a tolerance of a wall of the box.

    Parameters
    ----------
    hull : SupportMap
    body : Motion
    wall : 0 to 5, in the order x-, x+, y-, y+, z-, z+
    half : m, from the centre of the box to the wall
    begin, end, tolerance : as for `time_of_impact`
    """
    axis, sign = wall // 2, 2.0 * (wall % 2) - 1.0
    inward = (-sign if axis == 0 else 0.0, -sign if axis == 1 else 0.0, -sign if axis == 2 else 0.0)
    closing = turning_speed(inward, body) - dot(inward, body.velocity)
    time, gap = begin, 0.0
    for step in range(1, MOST_STEPS + 1):
        m = orientation(body, time)
        row = m[0] if axis == 0 else (m[1] if axis == 1 else m[2])
        vertex = support(hull, sign * row[0], sign * row[1], sign * row[2])
        reach = sign * dot(row, (hull.vertices[vertex, 0], hull.vertices[vertex, 1], hull.vertices[vertex, 2]))
        gap = half + dot(inward, place(body, time)) - body.size * reach
        if gap <= max(tolerance, MARGIN * (body.size + half)):
            return Impact(SearchVerdict.FOUND, time, max(0.0, gap), inward, COLD_START, step)
        if closing <= 0.0:
            return Impact(SearchVerdict.NEVER, np.inf, gap, inward, COLD_START, step)
        time += gap / closing
        if step % STEPS_PER_SWEEP == 0:
            time = apart_from_wall_until(hull, body, inward, half, time)
        if time > end:
            return Impact(SearchVerdict.NEVER, end, gap, inward, COLD_START, step)
    return Impact(SearchVerdict.STALLED, time, gap, inward, COLD_START, MOST_STEPS)
