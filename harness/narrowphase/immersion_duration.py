"""For how long two surfaces in free flight certainly go on crossing each other, because one is deep in the other.

A surface in one piece with a point inside a closed one and a point outside of it crosses it. Both points stay where
they are for as long as it takes them to pass the other body by their clearance from its surface, which is looked up in
its field. Crossing triangles prove the same for a tenth of that time, but also where bodies barely touch.

Where the closed surface has caps, what crosses it does so elsewhere while the caps are clear of the other surface.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.kernel import kernel, strict_step
from harness.narrowphase.clearance_field import HALF, ClearanceField
from harness.narrowphase.crossing_duration import passing_velocity
from harness.narrowphase.free_flight import RelativeMotion
from harness.narrowphase.vectors import Matrix, Vector, dot, plus, scaled, turned, turned_back

# Of the diameter: what is farther from the centre than this, is outside of the sphere around the body.
OUTSIDE = 0.5 + 1e-9
# Of the size: the clearance that rounding of positions may take away.
ROUNDING = 1e-9


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


class Turning(NamedTuple):
    """What bends the way of a point of one body, as seen from another, which turns.

    Attributes
    ----------
    bend, growth : m/s^2 and m/s^3: after t the point has accelerated by at most bend + growth t
    """

    bend: float
    growth: float


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
    rate_a, rate_b = sqrt(dot(seen.spin_a, seen.spin_a)), sqrt(dot(seen.spin_b, seen.spin_b))
    apart, speed = sqrt(dot(pose.offset, pose.offset)), sqrt(dot(seen.drift, seen.drift))
    from_b = turning(rate_a, reach_a, rate_b, apart, speed)
    from_a = turning(rate_b, reach_b, rate_a, apart, speed)

    lasts = 0.0
    for side in range(2):
        points, field, place, bends = (
            (field_a.points, field_b, to_b, from_b) if side == 0 else (field_b.points, field_a, to_a, from_a)
        )
        inmost, outmost = extremes(points, field, place)
        if inmost < 0 or outmost < 0:
            continue
        time = np.inf
        for end in range(2):
            k = inmost if end == 0 else outmost
            point = points[k, 0], points[k, 1], points[k, 2]
            sign = 1.0 if end == 0 else -1.0
            clear = place.size * max(0.0, sign * clearance(field, seen_in(place, point)) - ROUNDING)
            time = min(time, until_passed(clear, placed_point(point, side, seen), bends, seen))
        other, back, its = (field_a, to_a, from_a) if side == 0 else (field_b, to_b, from_b)
        for k in range(len(field.caps)):
            cap = field.caps[k, 0], field.caps[k, 1], field.caps[k, 2]
            clear = back.size * (abs(clearance(other, seen_in(back, cap))) - ROUNDING) - place.size * field.caps[k, 3]
            time = min(time, until_passed(max(0.0, clear), placed_point(cap, 1 - side, seen), its, seen))
        lasts = max(lasts, time)
    return lasts


@kernel
def extremes(points: Floats, field: ClearanceField, place: FieldPlace) -> tuple[int, int]:
    """Which points are, by the nearest nodes, farthest inside and farthest outside of a surface; -1 if none is."""
    values, n = field.values, len(field.values)
    scale = (n - 1) / (2.0 * HALF)
    m, c = place.matrix, place.centre
    low = high = np.float32(0.0)
    inmost = outmost = -1
    for k in range(len(points)):
        p, q, r = points[k, 0], points[k, 1], points[k, 2]
        x = c[0] + (m[0][0] * p + m[0][1] * q + m[0][2] * r)
        y = c[1] + (m[1][0] * p + m[1][1] * q + m[1][2] * r)
        z = c[2] + (m[2][0] * p + m[2][1] * q + m[2][2] * r)
        if max(abs(x), abs(y), abs(z)) < HALF:
            value = values[int((x + HALF) * scale + 0.5), int((y + HALF) * scale + 0.5), int((z + HALF) * scale + 0.5)]
        else:
            value = np.float32(0.5 - sqrt(x * x + y * y + z * z))
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
    pitch = 2.0 * HALF / (len(field.values) - 1)
    i, j, k = int((x + HALF) / pitch + 0.5), int((y + HALF) / pitch + 0.5), int((z + HALF) / pitch + 0.5)
    x, y, z = x - (i * pitch - HALF), y - (j * pitch - HALF), z - (k * pitch - HALF)
    value, off = float(field.values[i, j, k]), sqrt(x * x + y * y + z * z)
    return max(0.0, value - off) if value > 0.0 else min(0.0, value + off)


@strict_step
def seen_in(place: FieldPlace, point: Vector) -> Vector:
    """A point of the one body, of size 1, in the field of the other."""
    return plus(place.centre, turned(place.matrix, point))


@strict_step
def times(m: Matrix, factor: float) -> Matrix:
    """A matrix times a number."""
    return scaled(m[0], factor), scaled(m[1], factor), scaled(m[2], factor)


@strict_step
def placed_point(point: Vector, side: int, seen: RelativeMotion) -> Vector:
    """A point of body a (side 0) or b, from the centre of a in its axes, m."""
    pose = seen.pose
    if side == 0:
        return scaled(point, pose.size_a)
    return plus(pose.offset, scaled(turned(pose.rotation, point), pose.size_b))


@strict_step
def turning(rate: float, arm: float, rate_seen: float, apart: float, speed: float) -> Turning:
    """Of a point that goes round its own centre, with Coriolis and centrifugal terms, as in `crossing_lasts`."""
    bend = rate**2 * arm + 2.0 * rate_seen * (speed + rate * arm) + rate_seen**2 * (apart + arm)
    return Turning(bend, rate_seen**2 * speed)


@strict_step
def until_passed(clear: float, point: Vector, bends: Turning, seen: RelativeMotion) -> float:
    """How long a point certainly takes to pass the other body by a length, s."""
    velocity = passing_velocity(point, seen)
    speed = sqrt(dot(velocity, velocity))
    time = until(clear, speed, bends.bend)
    return until(clear, speed, bends.bend + bends.growth * time) if bends.growth > 0.0 else time


@strict_step
def until(clear: float, speed: float, bend: float) -> float:
    """When speed t + bend t^2 / 2 = clear, s."""
    root = speed + sqrt(speed * speed + 2.0 * bend * clear)
    return 2.0 * clear / root if root > 0.0 else np.inf
