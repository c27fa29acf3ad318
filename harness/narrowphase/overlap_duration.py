"""For how long two hulls in free flight certainly go on overlapping, once they do.

They overlap while the origin is inside a tetrahedron of differences of their points. Its corners move no faster, and
turn no more sharply, than the bodies let them.
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

# Rounds of making a tetrahedron roomier.
ROUNDS = 10


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
    rate_a, rate_b = sqrt(dot(seen.spin_a, seen.spin_a)), sqrt(dot(seen.spin_b, seen.spin_b))
    time = np.inf
    for k in range(4):
        vertices = s0 if k == 0 else (s1 if k == 1 else (s2 if k == 2 else s3))
        round_a = cross(seen.spin_a, vertex_a(hull_a, pose, vertices >> 32))
        round_b = cross(seen.spin_b, minus(vertex_b(hull_b, pose, vertices & 0xFFFFFFFF), pose.offset))
        velocity = minus(minus(round_a, round_b), seen.drift)
        speed = sqrt(dot(velocity, velocity))
        bend = rate_a * sqrt(dot(round_a, round_a)) + rate_b * sqrt(dot(round_b, round_b))
        if speed > 0.0 or bend > 0.0:
            time = min(time, 2.0 * radius / (speed + sqrt(speed * speed + 2.0 * bend * radius)))
    return Overlap(max(0.0, time), (s0, s1, s2, s3))


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
