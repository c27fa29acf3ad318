"""For how long two hulls in free flight certainly stay near each other, though they may come apart.

Their gap is no wider than the way from the origin to any point of their Minkowski difference, so to any of a vertex,
edge or face of it. As the bodies move, so do its corners, each on a way that is nearly straight; and where the bodies
slide over each other, the nearest point goes from one part of it to another, too.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple, TypeAlias

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.free_flight import RelativeMotion
from harness.narrowphase.gjk import WarmStart, difference
from harness.narrowphase.overlap_duration import motion_of_corner
from harness.narrowphase.simplex import weights
from harness.narrowphase.support import SupportMap
from harness.narrowphase.vectors import Vector, dot, minus, plus, scaled

# Of the time until which the gap would stay narrow enough, were its rate constant: what is tried first; how much less
# is tried next, and how often.
NEARLY, LESS, MOST_TRIALS = 1.0 - 1.0 / 64.0, 0.25, 8

Three: TypeAlias = tuple[Vector, Vector, Vector]
"""A vector for each corner."""


class MovingSimplex(NamedTuple):
    """A vertex, an edge or a face of a Minkowski difference.

    Attributes
    ----------
    places, velocities : m and m/s, of its corners; of no meaning from the size on
    bend : m/s^2, by which they accelerate at the most
    size : how many corners it has
    """

    places: Three
    velocities: Three
    bend: float
    size: int


@kernel
def stays_near(hull_a: SupportMap, hull_b: SupportMap, seen: RelativeMotion, corners: WarmStart, limit: float) -> float:
    """For how long no gap between two hulls is wider than a limit, s, as a simplex shows; 0 where it does not.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    seen : RelativeMotion of the bodies
    corners : of one to three vertices of the Minkowski difference that are near the origin, and -1 for the others
    limit : m
    """
    simplex = moving_simplex(hull_a, hull_b, seen, corners)
    a, b, c = simplex.places
    now = shares(a, b, c, simplex.size)
    point = combined(simplex.places, now)
    width = sqrt(dot(point, point))
    if not 0.0 < width < limit:
        return 0.0
    rate = dot(point, combined(simplex.velocities, now)) / width
    # one that closes goes on to beyond the origin, and is as far again there
    time = (limit - width) / rate if rate > 0.0 else (limit + width) / -rate if rate < 0.0 else np.inf
    # until then the accelerations take no more than half of what is left
    time = NEARLY * min(time, sqrt((limit - width) / simplex.bend) if simplex.bend > 0.0 else np.inf)
    for _ in range(MOST_TRIALS):
        if time < np.inf and widest(simplex, now, width, time) <= limit:
            return time
        time *= LESS
    return 0.0


@strict_step
def widest(simplex: MovingSimplex, now: Vector, width: float, time: float) -> float:
    """A bound that the distance of the simplex from the origin does not exceed until a time, m.

    Of its nearest point now and then, both in shares of the corners, the shares in between are taken: were the corners
    straight, that point would run along a parabola, which is off its chord by a quarter of its last term.
    """
    (a, b, c), (u, v, w) = simplex.places, simplex.velocities
    a, b, c = plus(a, scaled(u, time)), plus(b, scaled(v, time)), plus(c, scaled(w, time))
    then = shares(a, b, c, simplex.size)
    point, off = combined((a, b, c), then), combined(simplex.velocities, minus(then, now))
    farther = max(width, sqrt(dot(point, point)))
    return farther + 0.25 * time * sqrt(dot(off, off)) + 0.5 * simplex.bend * time * time


@strict_step
def shares(a: Vector, b: Vector, c: Vector, size: int) -> Vector:
    """Of the corners, in the point of the simplex nearest to the origin if none is below 0, and in one near it else."""
    at_a, at_b, at_c = weights(a, b, c, size)
    at_a, at_b, at_c = max(at_a, 0.0), max(at_b, 0.0), max(at_c, 0.0)
    whole = at_a + at_b + at_c
    return at_a / whole, at_b / whole, at_c / whole


@strict_step
def combined(of: Three, by: Vector) -> Vector:
    """The sum of three vectors, each times its share."""
    return plus(plus(scaled(of[0], by[0]), scaled(of[1], by[1])), scaled(of[2], by[2]))


@strict_step
def moving_simplex(hull_a: SupportMap, hull_b: SupportMap, seen: RelativeMotion, corners: WarmStart) -> MovingSimplex:
    """The simplex of these corners; the first stands in for those that it has not."""
    s0 = corners[0]
    s1 = corners[1] if corners[1] >= 0 else s0
    s2 = corners[2] if corners[2] >= 0 else s0
    size = 1 + (corners[1] >= 0) + (corners[2] >= 0)
    u, bend_a = motion_of_corner(hull_a, hull_b, seen, s0)
    v, bend_b = motion_of_corner(hull_a, hull_b, seen, s1)
    w, bend_c = motion_of_corner(hull_a, hull_b, seen, s2)
    pose = seen.pose
    places = (
        difference(hull_a, hull_b, pose, s0),
        difference(hull_a, hull_b, pose, s1),
        difference(hull_a, hull_b, pose, s2),
    )
    return MovingSimplex(places, (u, v, w), max(max(bend_a, bend_b), bend_c), size)
