"""Conservative advancement: when two convex hulls in free flight touch, or a hull and a wall.

A gap along an axis cannot close faster than the bodies approach along it, and their points turn into it. So time may be
advanced by the gap over that speed without any risk of passing a contact, and again from there (Mirtich, 1996). A
bound of second order, from the speeds at which the points do move, takes longer steps: `open_for`. The first
bound holds because hulls are convex: where it is not positive they never touch. For concave bodies it proves nothing.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import inner, kernel
from harness.narrowphase.gjk import MARGIN, NO_SEEDS, Seeds, hull_distance, relative_pose
from harness.narrowphase.support import SupportMap, support
from harness.narrowphase.vectors import Matrix, Vector, cross, dot, minus, plus, rotation, scaled, turned, turned_back

NEVER, IMPACT, STALLED = 0, 1, 2

# Steps after which a search is given up where it stands. Ordinary ones take 2 to 50.
MOST_STEPS = 1000
# Trials of the length of a step.
MOST_TRIALS = 3


class Motion(NamedTuple):
    """A body in free flight: where it is at time 0, and how it moves.

    Attributes
    ----------
    position : m
    velocity : m/s
    quaternion : w, x, y, z
    spin : rad/s, in the world
    size : m, factor on the vertices of the hull
    reach : m, farthest that any of its points is from its axis of spin through the centre, or more
    """

    position: Vector
    velocity: Vector
    quaternion: tuple[float, float, float, float]
    spin: Vector
    size: float
    reach: float


class Impact(NamedTuple):
    """What a search has found.

    Attributes
    ----------
    verdict : IMPACT; NEVER, if nothing touches until the end of the window; STALLED, if it was given up
    time : s, before which nothing touches; of the impact, if there is one, else the end of the window or inf
    gap : m, what was left of the gap at that time
    axis : of the gap, pointing away from the second body or the wall, in the world; a unit vector
    seeds : for the next search of this pair
    steps : distances measured
    """

    verdict: int
    time: float
    gap: float
    axis: Vector
    seeds: Seeds
    steps: int


@kernel
def time_of_impact(
    hull_a: SupportMap,
    hull_b: SupportMap,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    seeds: Seeds,
) -> Impact:
    """When two hulls come within a tolerance of each other.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    a, b : Motion
    begin, end : s, the window; the end may be inf
    tolerance : m, the gap at which hulls count as touching
    seeds : of an earlier search for this pair, or NO_SEEDS

    Returns
    -------
    Impact
        At a time not after the true first contact, and at which the hulls are no farther apart than the tolerance. Of
        hulls that overlap at the beginning, at the beginning.
    """
    margin = MARGIN * (a.size + b.size)
    near = max(tolerance, 8.0 * margin)
    aim = near / 4.0  # a little before contact, where the axis of the gap can still be told from rounding
    time, axis, gap = begin, (0.0, 0.0, 0.0), 0.0
    for step in range(1, MOST_STEPS + 1):
        turn_a, turn_b = orientation(a, time), orientation(b, time)
        offset = minus(place(b, time), place(a, time))
        pose = relative_pose(turn_a, a.size, turn_b, b.size, offset)
        found = hull_distance(hull_a, hull_b, pose, seeds, scaled(pose.offset, -1.0), margin, np.inf)
        seeds, gap = found.seeds, found.upper
        length = sqrt(dot(found.axis, found.axis))
        if length > 0.0:
            axis = turned(turn_a, scaled(found.axis, 1.0 / length))
        if gap <= near or found.lower <= aim:
            return Impact(IMPACT, time, gap, axis, seeds, step)
        drift = dot(axis, minus(b.velocity, a.velocity))
        closing = drift + turning(axis, a) + turning(axis, b)
        if closing <= 0.0:
            return Impact(NEVER, np.inf, gap, axis, seeds, step)
        room = found.lower - aim
        wait = room / closing
        if time + wait <= end:
            arm_a, arm_b = turned(turn_a, found.point_a), minus(turned(turn_a, found.point_b), offset)
            longer = open_for(hull_a, hull_b, a, b, turn_a, turn_b, axis, room, drift, arm_a, arm_b)
            wait = longer if longer > wait else wait
        time += wait
        if time > end:
            return Impact(NEVER, end, gap, axis, seeds, step)
    return Impact(STALLED, time, gap, axis, seeds, MOST_STEPS)


@kernel
def open_for(
    hull_a: SupportMap,
    hull_b: SupportMap,
    a: Motion,
    b: Motion,
    turn_a: Matrix,
    turn_b: Matrix,
    axis: Vector,
    room: float,
    drift: float,
    arm_a: Vector,
    arm_b: Vector,
) -> float:
    """How long a gap along an axis stays open, s, by what the hulls do at first and what their spins can change of it.

    A point at p from its centre moves along the axis n at p.(n x w), which changes by at most |n x w| |w x p| a second.
    So after t no point of a hull is farther along than its support function in the direction n + t (n x w) says, and
    t^2 / 2 times this bound. As a function of t the gap left is concave: open now and later, it is open between.

    Parameters
    ----------
    axis : unit vector from b to a
    room : m, of the gap
    drift : m/s, at which the centres approach along the axis
    arm_a, arm_b : m, from either centre to the point that is nearest now
    """
    across_a, across_b = cross(axis, a.spin), cross(axis, b.spin)
    bend = sqrt(dot(across_a, across_a) * dot(a.spin, a.spin)) * a.reach
    bend += sqrt(dot(across_b, across_b) * dot(b.spin, b.spin)) * b.reach
    rate = dot(across_a, arm_a) - dot(across_b, arm_b) - drift
    if bend == 0.0:
        return 0.0  # the first bound is as good
    root = sqrt(rate * rate + 2.0 * bend * room)
    time = (rate + root) / bend if rate > 0.0 else 2.0 * room / (root - rate)
    at_begin = reach_towards(hull_a, hull_b, a, b, turn_a, turn_b, axis, axis)
    safe, left_safe, beyond, left_beyond = 0.0, room, time, 0.0
    for trial in range(MOST_TRIALS):
        forward_a, forward_b = plus(axis, scaled(across_a, time)), plus(axis, scaled(across_b, time))
        used = reach_towards(hull_a, hull_b, a, b, turn_a, turn_b, forward_a, forward_b) - at_begin
        left = room - used - time * (drift + 0.5 * bend * time)
        if left >= 0.0:
            safe, left_safe = time, left
            if trial == 0:
                return time
        else:
            beyond, left_beyond = time, left
        # the chord between them runs below the gap
        time = safe + (beyond - safe) * left_safe / (left_safe - left_beyond)
    return time


@inner
def reach_towards(
    hull_a: SupportMap,
    hull_b: SupportMap,
    a: Motion,
    b: Motion,
    turn_a: Matrix,
    turn_b: Matrix,
    axis_a: Vector,
    axis_b: Vector,
) -> float:
    """How far hull a reaches against an axis from its centre, and hull b along one, together, m."""
    back_a, back_b = turned_back(turn_a, axis_a), turned_back(turn_b, axis_b)
    k, m = support(hull_a, -back_a[0], -back_a[1], -back_a[2]), support(hull_b, back_b[0], back_b[1], back_b[2])
    low = hull_a.vertices[k, 0], hull_a.vertices[k, 1], hull_a.vertices[k, 2]
    high = hull_b.vertices[m, 0], hull_b.vertices[m, 1], hull_b.vertices[m, 2]
    return b.size * dot(back_b, high) - a.size * dot(back_a, low)


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
    closing = turning(inward, body) - dot(inward, body.velocity)
    time, gap = begin, 0.0
    for step in range(1, MOST_STEPS + 1):
        m = orientation(body, time)
        row = m[0] if axis == 0 else (m[1] if axis == 1 else m[2])
        vertex = support(hull, sign * row[0], sign * row[1], sign * row[2])
        reach = sign * dot(row, (hull.vertices[vertex, 0], hull.vertices[vertex, 1], hull.vertices[vertex, 2]))
        gap = half + dot(inward, place(body, time)) - body.size * reach
        if gap <= max(tolerance, MARGIN * (body.size + half)):
            return Impact(IMPACT, time, max(0.0, gap), inward, NO_SEEDS, step)
        if closing <= 0.0:
            return Impact(NEVER, np.inf, gap, inward, NO_SEEDS, step)
        time += gap / closing
        if time > end:
            return Impact(NEVER, end, gap, inward, NO_SEEDS, step)
    return Impact(STALLED, time, gap, inward, NO_SEEDS, MOST_STEPS)


@kernel
def turning(axis: Vector, body: Motion) -> float:
    """How fast a point of a spinning body can move along an axis that stands still, m/s, besides its flight.

    (w x p).n = p.(n x w), so that only the spin across the axis counts: a body that spins about it closes no gap.
    """
    across = cross(axis, body.spin)
    return sqrt(dot(across, across)) * body.reach


@kernel
def place(body: Motion, time: float) -> Vector:
    """Of the centre, m."""
    return plus(body.position, scaled(body.velocity, time))


@kernel
def orientation(body: Motion, time: float) -> Matrix:
    """From the axes of the body to those of the world."""
    w, x, y, z = attitude(body, time)
    return rotation(w, x, y, z)


@kernel
def attitude(body: Motion, time: float) -> tuple[float, float, float, float]:
    """exp(w t) q."""
    x, y, z = body.spin
    w0, x0, y0, z0 = body.quaternion
    rate = sqrt(x * x + y * y + z * z)
    if rate == 0.0:
        return w0, x0, y0, z0
    c, s = cos(0.5 * rate * time), sin(0.5 * rate * time) / rate
    x, y, z = s * x, s * y, s * z
    return (
        c * w0 - x * x0 - y * y0 - z * z0,
        c * x0 + x * w0 + y * z0 - z * y0,
        c * y0 - x * z0 + y * w0 + z * x0,
        c * z0 + x * y0 - y * x0 + z * w0,
    )
