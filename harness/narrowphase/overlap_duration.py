"""For how long two hulls in free flight certainly go on overlapping, once they do.

They overlap while the origin is inside a tetrahedron of differences of their points. Its corners move no faster, and
turn no more sharply, than the bodies let them. That proves for how long the origin stays inside, by its distance from
the nearest face, whichever way the corners move; and for longer, by which way they do: faces that slide over each other
at a small depth may go on to.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel
from harness.narrowphase.free_flight import RelativeMotion
from harness.narrowphase.gjk import WarmStart, difference, farthest, vertex_a, vertex_b
from harness.narrowphase.simplex import depth_of_origin
from harness.narrowphase.support import SupportMap
from harness.narrowphase.vectors import Vector, cross, dot, minus, scaled

# Steps that replace a corner, so that the origin is deeper in the tetrahedron.
ROUNDS = 10
# By how much longer a time is tried than one that is proved, how often, and how often it is halved again then.
LONGER, MOST_LONGER, HALVINGS = 8.0, 12, 3
# Of the product of the lengths of three corners: more than rounding takes from their volume.
ROUNDING = 1e-14


class MovingCorners(NamedTuple):
    """The corners of a tetrahedron.

    Attributes
    ----------
    places : m, where they are
    velocities : m/s
    bend : m/s^2, by which they accelerate at the most
    """

    places: tuple[Vector, Vector, Vector, Vector]
    velocities: tuple[Vector, Vector, Vector, Vector]
    bend: float


class Overlap(NamedTuple):
    """Two hulls that overlap.

    Attributes
    ----------
    lasts : s, for how long they go on to
    warm_start : the corners of the tetrahedron that shows it
    """

    lasts: float
    warm_start: WarmStart


@kernel
def overlap_lasts(hull_a: SupportMap, hull_b: SupportMap, seen: RelativeMotion, corners: WarmStart) -> Overlap:
    """For how long two overlapping hulls certainly go on to overlap.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    seen : RelativeMotion of the bodies
    corners : of a tetrahedron around the origin, as `gjk.hull_distance` gives them
    """
    pose = seen.pose
    s0, s1, s2, s3 = corners
    p0, p1 = difference(hull_a, hull_b, pose, s0), difference(hull_a, hull_b, pose, s1)
    p2, p3 = difference(hull_a, hull_b, pose, s2), difference(hull_a, hull_b, pose, s3)
    radius = depth_of_origin(p0, p1, p2, p3)
    for _ in range(ROUNDS):
        outward = outward_of_nearest(p0, p1, p2, p3)
        vertices = farthest(hull_a, hull_b, pose, outward)
        point = difference(hull_a, hull_b, pose, vertices)
        at0, at1 = depth_of_origin(point, p1, p2, p3), depth_of_origin(p0, point, p2, p3)
        at2, at3 = depth_of_origin(p0, p1, point, p3), depth_of_origin(p0, p1, p2, point)
        best = max(max(at0, at1), max(at2, at3))
        if not best > radius:
            break
        radius = best
        if best == at0:
            p0, s0 = point, vertices
        elif best == at1:
            p1, s1 = point, vertices
        elif best == at2:
            p2, s2 = point, vertices
        else:
            p3, s3 = point, vertices
    v0, bend0 = motion_of_corner(hull_a, hull_b, seen, s0)
    v1, bend1 = motion_of_corner(hull_a, hull_b, seen, s1)
    v2, bend2 = motion_of_corner(hull_a, hull_b, seen, s2)
    v3, bend3 = motion_of_corner(hull_a, hull_b, seen, s3)
    bend = max(max(bend0, bend1), max(bend2, bend3))
    speed = sqrt(max(max(dot(v0, v0), dot(v1, v1)), max(dot(v2, v2), dot(v3, v3))))
    root = speed + sqrt(speed * speed + 2.0 * bend * max(0.0, radius))
    time = 2.0 * max(0.0, radius) / root if root > 0.0 else np.inf
    if 0.0 < time < np.inf:
        time = longest_inside(MovingCorners((p0, p1, p2, p3), (v0, v1, v2, v3), bend), time)
    return Overlap(time, (s0, s1, s2, s3))


@kernel
def motion_of_corner(
    hull_a: SupportMap, hull_b: SupportMap, seen: RelativeMotion, vertices: int
) -> tuple[Vector, float]:
    """How fast a difference of two vertices moves, m/s, and by how much it accelerates at the most, m/s^2."""
    pose = seen.pose
    round_a = cross(seen.spin_a, vertex_a(hull_a, pose, vertices >> 32))
    round_b = cross(seen.spin_b, minus(vertex_b(hull_b, pose, vertices & 0xFFFFFFFF), pose.offset))
    bend = sqrt(dot(seen.spin_a, seen.spin_a) * dot(round_a, round_a))
    bend += sqrt(dot(seen.spin_b, seen.spin_b) * dot(round_b, round_b))
    return minus(minus(round_a, round_b), seen.drift), bend


@kernel
def longest_inside(corners: MovingCorners, known: float) -> float:
    """For how long the origin certainly stays inside a tetrahedron, s; no less than is known."""
    time, fails = known, np.inf
    for _ in range(MOST_LONGER):
        if not stays_inside(corners, LONGER * time):
            fails = LONGER * time
            break
        time *= LONGER
    for _ in range(HALVINGS):
        middle = 0.5 * (time + fails)
        if middle < np.inf and stays_inside(corners, middle):
            time = middle
        else:
            fails = middle
    return time


@kernel
def stays_inside(corners: MovingCorners, time: float) -> bool:
    """Whether the origin certainly stays inside a tetrahedron until a time, s: on the inner side of each face.

    That is the sign of the volume between the origin and the face, a cubic of time but for what the corners bend.
    """
    (a, b, c, d), (u, v, w, x), bend = corners
    sign = 1.0 if dot(cross(minus(a, d), minus(b, d)), minus(c, d)) > 0.0 else -1.0
    slack = 0.5 * bend * time * time
    return (
        least_volume(a, b, c, u, v, w, sign, time, slack) > 0.0
        and least_volume(b, a, d, v, u, x, sign, time, slack) > 0.0
        and least_volume(a, c, d, u, w, x, sign, time, slack) > 0.0
        and least_volume(c, b, d, w, v, x, sign, time, slack) > 0.0
    )


@kernel
def least_volume(
    a: Vector, b: Vector, c: Vector, u: Vector, v: Vector, w: Vector, sign: float, time: float, slack: float
) -> float:
    """A bound below which six times the volume between the origin and a face, of a sign, does not come until a time.

    Parameters
    ----------
    a, b, c : m, the corners of the face
    u, v, w : m/s, their velocities
    sign : 1, or -1 for the negative volume
    time : s
    slack : m, by which a corner can be off its straight way
    """
    first = sign * dot(cross(a, b), c)
    second = sign * time * (dot(cross(u, b), c) + dot(cross(a, v), c) + dot(cross(a, b), w))
    third = sign * time * time * (dot(cross(u, v), c) + dot(cross(u, b), w) + dot(cross(a, v), w))
    fourth = sign * time * time * time * dot(cross(u, v), w)
    # a cubic is no farther below its chord than a quarter and 2 / sqrt(27) of its last terms
    least = min(first, first + second + third + fourth) - 0.25 * abs(third) - 0.385 * abs(fourth)
    p = sqrt(dot(a, a)) + time * sqrt(dot(u, u))
    q = sqrt(dot(b, b)) + time * sqrt(dot(v, v))
    r = sqrt(dot(c, c)) + time * sqrt(dot(w, w))
    bent = slack * (p * q + q * r + r * p + slack * (p + q + r + slack))
    return least - bent - ROUNDING * p * q * r


@kernel
def outward_of_nearest(a: Vector, b: Vector, c: Vector, d: Vector) -> Vector:
    """Of the face of a tetrahedron that is nearest to the origin, which is inside: away from it."""
    best, nearest = a, np.inf
    for face in range(4):
        p, q, r = (a, b, c) if face == 0 else ((b, c, d) if face == 1 else ((c, d, a) if face == 2 else (d, a, b)))
        normal = cross(minus(q, p), minus(r, p))
        length = sqrt(dot(normal, normal))
        height = dot(normal, p)
        if abs(height) < nearest * length:
            nearest, best = abs(height) / length, scaled(normal, 1.0 if height > 0.0 else -1.0)
    return best
