"""For how long two surfaces in free flight certainly go on crossing each other, because one is deep in the other.

A surface in one piece with a point inside a closed one and a point outside of it crosses it. Both points stay where
they are for as long as it takes them to pass the other body by their clearance from its surface, which is looked up in
its field, and again from where they are then. Crossing triangles prove the same for a tenth of that time, but also
where bodies barely touch.

Where the closed surface has caps, what crosses it does so elsewhere while the caps are clear of the other surface.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.kernel import kernel, strict_step
from harness.narrowphase.clearance_field import HALF, ClearanceField
from harness.narrowphase.free_flight import RelativeMotion
from harness.narrowphase.gjk import Relative
from harness.narrowphase.vectors import Matrix, Vector, cross, dot, minus, plus, scaled, turned, turned_back

# Of the diameter: what is farther from the centre than this, is outside of the sphere around the body.
OUTSIDE = 0.5 + 1e-9
# Of the size: the clearance that rounding of positions may take away.
ROUNDING = 1e-9
# Steps along the way of a point, at most; and of the time found so far, what a step must add for another.
MOST_STEPS, WORTH = 24, 0.1
# Cells from the surface, within which all nodes around a point are asked: by the nearest alone, a clearance is found
# half a cell too short.
NEAR_SURFACE = 3.0


class FieldPlace(NamedTuple):
    """Where points of one body are in the field of another: centre + matrix point, in units of the other body.

    Attributes
    ----------
    matrix : Matrix
    centre : of the one, seen from the other
    size : m, of the other, which turns clearances into lengths
    """

    matrix: Matrix
    centre: Vector
    size: float


class TrackedPoint(NamedTuple):
    """A point of one body that is followed through the field of the other.

    Attributes
    ----------
    point : m, in axes that do not turn, those of body a at first, from the centre of its body
    side : 0 if it is a point of body a, 1 if of b
    reach : m, the farthest that a point of its body is from the centre
    less : m, by which its clearance is shortened: the radius of what is around it
    sign : 1 if it is to stay inside, -1 if outside, 0 if where it is
    """

    point: Vector
    side: int
    reach: float
    less: float
    sign: float


@kernel
def immersion_lasts(
    field_a: ClearanceField, field_b: ClearanceField, reach_a: float, reach_b: float, seen: RelativeMotion
) -> float:
    """For how long two surfaces certainly go on crossing each other, s; 0 where that is not proved.

    Parameters
    ----------
    field_a, field_b : ClearanceField
    reach_a, reach_b : m, the farthest that a point of either body is from its centre
    seen : RelativeMotion of the bodies
    """
    if len(field_a.points) == 0 or len(field_b.points) == 0:
        return 0.0
    pose = seen.pose
    r, shrink_a, shrink_b = pose.rotation, 1.0 / pose.size_a, 1.0 / pose.size_b
    inverse = (r[0][0], r[1][0], r[2][0]), (r[0][1], r[1][1], r[2][1]), (r[0][2], r[1][2], r[2][2])
    to_b = FieldPlace(
        times(inverse, pose.size_a * shrink_b), scaled(turned_back(r, pose.offset), -shrink_b), pose.size_b
    )
    to_a = FieldPlace(times(r, pose.size_b * shrink_a), scaled(pose.offset, shrink_a), pose.size_a)
    lasts = 0.0
    for side in range(2):
        points, field, place = (field_a.points, field_b, to_b) if side == 0 else (field_b.points, field_a, to_a)
        other, reach, its_reach = (field_a, reach_a, reach_b) if side == 0 else (field_b, reach_b, reach_a)
        inmost, outmost = extremes(points, field, place)
        if inmost < 0 or outmost < 0:
            continue
        time = np.inf
        for end in range(2):
            k = inmost if end == 0 else outmost
            arm = arm_of(point_of(points, k), side, pose)
            tracked = TrackedPoint(arm, side, reach, 0.0, 1.0 if end == 0 else -1.0)
            time = stays(field, place.size, tracked, seen, time)
        for k in range(len(field.caps)):
            arm = arm_of((field.caps[k, 0], field.caps[k, 1], field.caps[k, 2]), 1 - side, pose)
            tracked = TrackedPoint(arm, 1 - side, its_reach, place.size * field.caps[k, 3], 0.0)
            time = stays(other, pose.size_a if side == 0 else pose.size_b, tracked, seen, time)
        lasts = max(lasts, time)
    return lasts


@kernel
def stays(field: ClearanceField, size: float, tracked: TrackedPoint, seen: RelativeMotion, enough: float) -> float:
    """For how long a point of one body certainly stays on its side of the other's surface, s, up to what is enough.

    Parameters
    ----------
    field, size : of the other body, whose size is in m
    tracked : TrackedPoint
    seen : RelativeMotion of the bodies
    enough : s
    """
    spin, its_spin = (seen.spin_a, seen.spin_b) if tracked.side == 0 else (seen.spin_b, seen.spin_a)
    rate, its_rate, speed = sqrt(dot(spin, spin)), sqrt(dot(its_spin, its_spin)), sqrt(dot(seen.drift, seen.drift))
    sign = 1.0 if tracked.side == 0 else -1.0
    away, drift = scaled(seen.pose.offset, -sign), scaled(seen.drift, -sign)
    r, time = seen.pose.rotation, 0.0
    for _ in range(MOST_STEPS):
        # seen from the centre of the other body, in axes that do not turn
        arm, centre = rotated(tracked.point, spin, rate, time), plus(away, scaled(drift, time))
        place = plus(centre, arm)
        there = rotated(place, its_spin, its_rate, -time)
        there = scaled(turned_back(r, there) if tracked.side == 0 else there, 1.0 / size)
        clear = clearance(field, there)
        clear = size * ((abs(clear) if tracked.sign == 0.0 else tracked.sign * clear) - ROUNDING) - tracked.less
        if not clear > 0.0:
            break
        passing = minus(plus(drift, cross(spin, arm)), cross(its_spin, place))
        # as seen from the other body, which turns: it goes round its own centre, and Coriolis and centrifugal terms
        apart, reach = sqrt(dot(centre, centre)), tracked.reach
        bend = rate**2 * reach + 2.0 * its_rate * (speed + rate * reach) + its_rate**2 * (apart + reach)
        wait = until_passed(clear, sqrt(dot(passing, passing)), bend, its_rate**2 * speed)
        time += wait
        if time >= enough:
            return enough
        if wait <= WORTH * time:
            break
    return time


@kernel
def extremes(points: Floats, field: ClearanceField, place: FieldPlace) -> tuple[int, int]:
    """Which points are, by the nearest nodes, farthest inside and farthest outside of a surface; -1 if none is.

    Only a choice: what is beyond the field is taken for what is at its border. Indices are worked out first, several at
    a time, and then looked up.
    """
    values, n = field.values, len(field.values)
    scale = (n - 1) / (2.0 * HALF)
    m, half = place.matrix, HALF * scale + 0.5
    (a, b, c), (d, e, f), (g, h, i) = times(m, scale)
    x, y, z = place.centre
    x, y, z = x * scale + half, y * scale + half, z * scale + half
    count = len(points) // 3
    last, nodes = np.int32(n - 1), np.empty(count, np.int32)
    for k in range(count):
        p, q, r = points[k], points[count + k], points[2 * count + k]
        u = min(max(np.int32(x + (a * p + b * q + c * r)), np.int32(0)), last)
        v = min(max(np.int32(y + (d * p + e * q + f * r)), np.int32(0)), last)
        w = min(max(np.int32(z + (g * p + h * q + i * r)), np.int32(0)), last)
        nodes[k] = (u * np.int32(n) + v) * np.int32(n) + w
    low = high = np.float32(0.0)
    inmost = outmost = -1
    flat = values.reshape(-1)
    for k in range(count):
        value = flat[nodes[k]]
        if value > high:
            high, inmost = value, k
        if value < low:
            low, outmost = value, k
    return inmost, outmost


@kernel
def clearance(field: ClearanceField, point: Vector) -> float:
    """How far a point certainly is inside of a surface; below 0 outside, 0 where it may be on it."""
    x, y, z = point
    if not max(abs(x), abs(y), abs(z)) < HALF:
        return min(0.0, OUTSIDE - sqrt(x * x + y * y + z * z))
    n = len(field.values)
    pitch = 2.0 * HALF / (n - 1)
    i, j, k = int((x + HALF) / pitch + 0.5), int((y + HALF) / pitch + 0.5), int((z + HALF) / pitch + 0.5)
    reach = 1 if abs(field.values[i, j, k]) < NEAR_SURFACE * pitch else 0
    inside = outside = 0.0
    for p in range(max(0, i - reach), min(n, i + reach + 1)):
        for q in range(max(0, j - reach), min(n, j + reach + 1)):
            for r in range(max(0, k - reach), min(n, k + reach + 1)):
                value = float(field.values[p, q, r])
                u, v, w = x - (p * pitch - HALF), y - (q * pitch - HALF), z - (r * pitch - HALF)
                off = sqrt(u * u + v * v + w * w)
                inside, outside = max(inside, value - off), min(outside, value + off)
    return inside if inside > 0.0 else outside


@strict_step
def times(m: Matrix, factor: float) -> Matrix:
    """A matrix times a number."""
    return scaled(m[0], factor), scaled(m[1], factor), scaled(m[2], factor)


@strict_step
def point_of(points: Floats, k: int) -> Vector:
    """A point of a field."""
    count = len(points) // 3
    return points[k], points[count + k], points[2 * count + k]


@strict_step
def arm_of(point: Vector, side: int, pose: Relative) -> Vector:
    """A point of body a (side 0) or b, from the centre of the body in the axes of a, m."""
    return scaled(point, pose.size_a) if side == 0 else scaled(turned(pose.rotation, point), pose.size_b)


@strict_step
def rotated(point: Vector, spin: Vector, rate: float, time: float) -> Vector:
    """Where a point goes that spins about the origin for a time."""
    if rate == 0.0:
        return point
    c, s = cos(rate * time), sin(rate * time) / rate
    along = dot(spin, point) * (1.0 - c) / (rate * rate)
    return plus(plus(scaled(point, c), scaled(cross(spin, point), s)), scaled(spin, along))


@strict_step
def until_passed(clear: float, speed: float, bend: float, growth: float) -> float:
    """How long a point certainly takes to pass the other body by a length, s.

    Parameters
    ----------
    clear : m, the length
    speed : m/s, at which it passes at first
    bend, growth : m/s^2 and m/s^3: after t it has accelerated by at most bend + growth t
    """
    time = until(clear, speed, bend)
    return until(clear, speed, bend + growth * time) if growth > 0.0 else time


@strict_step
def until(clear: float, speed: float, bend: float) -> float:
    """When speed t + bend t^2 / 2 = clear, s."""
    root = speed + sqrt(speed * speed + 2.0 * bend * clear)
    return 2.0 * clear / root if root > 0.0 else np.inf
