"""For how long two hulls in free flight certainly go on overlapping, once they do.

They overlap while the origin is inside a tetrahedron of differences of their points. Its corners move no faster, and
turn no more sharply, than the bodies let them. That proves for how long the origin stays inside, by its distance from
the nearest face, whichever way the corners move; and for longer, by which way they do: faces that slide over each other
at a small depth may go on to.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple, TypeAlias

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.free_flight import RelativeMotion
from harness.narrowphase.gjk import WarmStart, difference, farthest, vertex_a, vertex_b
from harness.narrowphase.simplex import depth_of_origin
from harness.narrowphase.support import SupportMap
from harness.narrowphase.vectors import Vector, cross, dot, minus, scaled

# Steps that replace a corner, so that the origin is deeper in the tetrahedron.
ROUNDS = 3
# By how much longer a time is tried than one that is proved, how often, and how often it is halved again then.
LONGER, MOST_LONGER, HALVINGS = 8.0, 12, 4
# Of the time at which the origin would leave the tetrahedron, were all rates constant: what is tried first.
NEARLY = 1.0 - 1.0 / 256.0
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


class CubicVolume(NamedTuple):
    """Six times a volume that changes as now + rate t + square t^2 + cube t^3 with the time t."""

    now: float
    rate: float
    square: float
    cube: float


FourLengths: TypeAlias = tuple[float, float, float, float]
"""Of the corners of a tetrahedron."""


class Overlap(NamedTuple):
    """Two hulls that overlap.

    Attributes
    ----------
    lasts : s, for how long they go on to
    depth : m, of the origin in the tetrahedron that shows it
    warm_start : the corners of that
    face : its corners that are nearest to the origin, and -1
    """

    lasts: float
    depth: float
    warm_start: WarmStart
    face: WarmStart


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
    face = (s0, s1, s2, -1)
    for _ in range(ROUNDS):
        outward, opposite = nearest_face(p0, p1, p2, p3)
        face = (s0 if opposite != 0 else s3, s1 if opposite != 1 else s3, s2 if opposite != 2 else s3, -1)
        vertices = farthest(hull_a, hull_b, pose, outward)
        point = difference(hull_a, hull_b, pose, vertices)
        # without the corner opposite to the face that the point is beyond, the origin would be outside
        at0 = depth_of_origin(point, p1, p2, p3) if opposite != 0 else 0.0
        at1 = depth_of_origin(p0, point, p2, p3) if opposite != 1 else 0.0
        at2 = depth_of_origin(p0, p1, point, p3) if opposite != 2 else 0.0
        at3 = depth_of_origin(p0, p1, p2, point) if opposite != 3 else 0.0
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
    return Overlap(time, radius, (s0, s1, s2, s3), face)


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
    (a, b, c, d), (u, v, w, x), bend = corners
    sign = 1.0 if dot(cross(minus(a, d), minus(b, d)), minus(c, d)) > 0.0 else -1.0
    at = sqrt(dot(a, a)), sqrt(dot(b, b)), sqrt(dot(c, c)), sqrt(dot(d, d))
    speeds = sqrt(dot(u, u)), sqrt(dot(v, v)), sqrt(dot(w, w)), sqrt(dot(x, x))
    volumes = (
        volume_over(a, b, c, u, v, w, sign),
        volume_over(b, a, d, v, u, x, sign),
        volume_over(a, c, d, u, w, x, sign),
        volume_over(c, b, d, w, v, x, sign),
    )
    time, fails, soonest = known, np.inf, NEARLY * soonest_exit(volumes)
    for _ in range(MOST_LONGER):
        trial = min(soonest, LONGER * time) if soonest > time else LONGER * time
        if not stays_inside(volumes, at, speeds, bend, trial):
            fails = trial
            break
        time = trial
    for _ in range(HALVINGS):
        trial = 0.5 * (time + fails)
        if trial < np.inf and stays_inside(volumes, at, speeds, bend, trial):
            time = trial
        else:
            fails = trial
    return time


@strict_step
def soonest_exit(volumes: tuple[CubicVolume, CubicVolume, CubicVolume, CubicVolume]) -> float:
    """When the first of the volumes would vanish, s, were their rates constant."""
    soonest = np.inf
    for volume in volumes:
        if volume.rate < 0.0:
            soonest = min(soonest, -volume.now / volume.rate)
    return soonest


@strict_step
def stays_inside(
    volumes: tuple[CubicVolume, CubicVolume, CubicVolume, CubicVolume],
    at: FourLengths,
    speeds: FourLengths,
    bend: float,
    time: float,
) -> bool:
    """Whether the origin certainly stays inside a tetrahedron until a time, s: on the inner side of each face.

    Parameters
    ----------
    volumes : over the faces that have not the fourth, third, second and first corner
    at, speeds : m and m/s, how far from the origin the corners are, and how fast they move
    bend : m/s^2, by which they accelerate at the most
    """
    slack = 0.5 * bend * time * time
    p, q, r, s = at[0] + time * speeds[0], at[1] + time * speeds[1], at[2] + time * speeds[2], at[3] + time * speeds[3]
    return (
        least_volume(volumes[0], p, q, r, time, slack) > 0.0
        and least_volume(volumes[1], q, p, s, time, slack) > 0.0
        and least_volume(volumes[2], p, r, s, time, slack) > 0.0
        and least_volume(volumes[3], r, q, s, time, slack) > 0.0
    )


@strict_step
def volume_over(a: Vector, b: Vector, c: Vector, u: Vector, v: Vector, w: Vector, sign: float) -> CubicVolume:
    """Six times the volume between the origin and a face, of a sign.

    Parameters
    ----------
    a, b, c : m, the corners of the face
    u, v, w : m/s, their velocities
    sign : 1, or -1 for the negative volume
    """
    return CubicVolume(
        sign * dot(cross(a, b), c),
        sign * (dot(cross(u, b), c) + dot(cross(a, v), c) + dot(cross(a, b), w)),
        sign * (dot(cross(u, v), c) + dot(cross(u, b), w) + dot(cross(a, v), w)),
        sign * dot(cross(u, v), w),
    )


@strict_step
def least_volume(volume: CubicVolume, p: float, q: float, r: float, time: float, slack: float) -> float:
    """A bound below which the volume between the origin and a face does not come until a time.

    Parameters
    ----------
    volume : CubicVolume
    p, q, r : m, the farthest that the corners come from the origin, but for what they bend
    time : s
    slack : m, by which a corner can be off its straight way
    """
    second, third = time * volume.rate, time * time * volume.square
    fourth = time * time * time * volume.cube
    # a cubic is no farther below its chord than a quarter and 2 / sqrt(27) of its last terms
    least = min(volume.now, volume.now + second + third + fourth) - 0.25 * abs(third) - 0.385 * abs(fourth)
    bent = slack * (p * q + q * r + r * p + slack * (p + q + r + slack))
    return least - bent - ROUNDING * p * q * r


@kernel
def nearest_face(a: Vector, b: Vector, c: Vector, d: Vector) -> tuple[Vector, int]:
    """Outward, along the normal of the face of a tetrahedron nearest to the origin, inside; and the corner opposite."""
    best, nearest, opposite = a, np.inf, 3
    for face in range(4):
        p, q, r = (b, c, d) if face == 0 else ((c, d, a) if face == 1 else ((d, a, b) if face == 2 else (a, b, c)))
        normal = cross(minus(q, p), minus(r, p))
        length = sqrt(dot(normal, normal))
        height = dot(normal, p)
        if abs(height) < nearest * length:
            nearest, best, opposite = abs(height) / length, scaled(normal, 1.0 if height > 0.0 else -1.0), face
    return best, opposite
