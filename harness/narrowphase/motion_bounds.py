"""How soon two discs or two triangles of spinning bodies in free flight can touch, at the earliest.

Along an axis that stands still, a point of a body that spins at w rad/s, at p from its centre, moves at p.(n x w), and
this speed changes by no more than |n x w| |w x p| a second, at any time, since p goes round the axis of spin. So a gap
g that changes at a rate r is still open after t if g + r t - a t^2 / 2 > 0, where a is the sum over both bodies.
It holds for every point by itself, and so for surfaces of any form.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.free_flight import Motion, orientation
from harness.narrowphase.tree_pairs import Proximity
from harness.narrowphase.triangle_tree import TriangleTree, centre_of, normal_of, radius_of, thickness_of
from harness.narrowphase.vectors import Matrix, Triangle, Vector, cross, dot, minus, plus, scaled, turned


class Flight(NamedTuple):
    """Two bodies as `seen_at` gives them, and how near each other their parts are looked at.

    Attributes
    ----------
    a, b : Motion
    rate_a, rate_b : rad/s, of their spins
    aim : m, the gap down to which parts stay apart
    """

    a: Motion
    b: Motion
    rate_a: float
    rate_b: float
    aim: float


class Instant(NamedTuple):
    """Where two bodies are at a time, from the centre of a, in the axes of the world.

    Attributes
    ----------
    flight : Flight
    turn_a, turn_b : from the axes of either body to those of the world
    offset : m, from a's centre to b's
    size_a, size_b : factors on their vertices
    """

    flight: Flight
    turn_a: Matrix
    turn_b: Matrix
    offset: Vector
    size_a: float
    size_b: float


class MovingDisc(NamedTuple):
    """What is below a node of a tree, at an instant.

    Attributes
    ----------
    arm : m, from the centre of the body to that of the disc
    velocity : m/s, of the centre of the disc as the body spins
    speed : m/s, its length
    radius : m
    normal : unit vector
    thickness : m, half of it
    """

    arm: Vector
    velocity: Vector
    speed: float
    radius: float
    normal: Vector
    thickness: float


@kernel
def flight_of(a: Motion, b: Motion, aim: float) -> Flight:
    return Flight(a, b, sqrt(dot(a.spin, a.spin)), sqrt(dot(b.spin, b.spin)), aim)


@strict_step
def instant_of(flight: Flight, time: float) -> Instant:
    a, b = flight.a, flight.b
    offset = plus(b.position, scaled(b.velocity, time))
    return Instant(flight, orientation(a, time), orientation(b, time), offset, a.size, b.size)


@strict_step
def moving_disc_a(tree: TriangleTree, at: Instant, node: int) -> MovingDisc:
    return moving_disc(tree, node, at.turn_a, at.flight.a)


@strict_step
def moving_disc_b(tree: TriangleTree, at: Instant, node: int) -> MovingDisc:
    return moving_disc(tree, node, at.turn_b, at.flight.b)


@strict_step
def moving_disc(tree: TriangleTree, node: int, turn: Matrix, body: Motion) -> MovingDisc:
    """The disc of a node of a body that is turned so."""
    size = body.size
    arm = scaled(turned(turn, centre_of(tree, node)), size)
    velocity = cross(body.spin, arm)
    radius, thickness = size * radius_of(tree, node), size * thickness_of(tree, node)
    return MovingDisc(
        arm, velocity, sqrt(dot(velocity, velocity)), radius, turned(turn, normal_of(tree, node)), thickness
    )


@strict_step
def triangle_of(tree: TriangleTree, k: int, turn: Matrix, size: float) -> Triangle:
    """The corners of a triangle of a body that is turned so, from the centre of the body, m."""
    c = tree.corners
    return (
        scaled(turned(turn, (c[k, 0, 0], c[k, 0, 1], c[k, 0, 2])), size),
        scaled(turned(turn, (c[k, 1, 0], c[k, 1, 1], c[k, 1, 2])), size),
        scaled(turned(turn, (c[k, 2, 0], c[k, 2, 1], c[k, 2, 2])), size),
    )


@strict_step
def until_discs_touch(one: MovingDisc, other: MovingDisc, at: Instant, horizon: float) -> Proximity:
    """How long two discs, of bodies a and b, stay apart; more than a horizon (s) does not matter."""
    a, b, rate_a, rate_b, margin = at.flight
    between = minus(plus(at.offset, other.arm), one.arm)
    squared = dot(between, between)
    reach = one.radius + other.radius + margin
    velocity = minus(plus(minus(b.velocity, a.velocity), other.velocity), one.velocity)
    time = 0.0
    if squared > reach * reach:
        distance = sqrt(squared)
        rate = dot(between, velocity) / distance
        time = until_closed(distance - reach, rate, rate_a * one.speed + rate_b * other.speed, horizon)
        if time == np.inf:
            return Proximity(time, np.inf)
    cosine = dot(one.normal, other.normal)
    sine = sqrt(max(0.0, 1.0 - cosine * cosine)) + 1e-7  # more than rounding takes from it
    cosine = abs(cosine)
    for slab in range(2):
        mine, its = (one, other) if slab == 0 else (other, one)
        along = dot(mine.normal, between)
        gap = abs(along) - (mine.thickness + its.thickness * cosine + its.radius * sine + margin)
        if gap > 0.0:
            turning_a, turning_b = across(mine.normal, a.spin), across(mine.normal, b.spin)
            rate = dot(mine.normal, velocity)
            rate = (rate if along > 0.0 else -rate) - turning_a * one.radius - turning_b * other.radius
            time = max(time, until_closed(gap, rate, turning_a * one.speed + turning_b * other.speed, horizon))
            if time == np.inf:
                return Proximity(time, np.inf)
    return Proximity(time, squared / (reach * reach))


@strict_step
def until_triangles_touch(one: Triangle, other: Triangle, axis: Vector, at: Instant, horizon: float) -> float:
    """How long two triangles stay apart along an axis that stands still, s.

    Parameters
    ----------
    one, other : Triangle of bodies a and b, from the centre of a, m
    axis : unit vector, from b to a
    at : Instant
    horizon : s, beyond which it does not matter; inf then
    """
    a, b = at.flight.a, at.flight.b
    across_a, across_b = cross(axis, a.spin), cross(axis, b.spin)
    drift = dot(axis, minus(a.velocity, b.velocity))
    bend = sqrt(dot(across_a, across_a)) * fastest(one, (0.0, 0.0, 0.0), a.spin)
    bend += sqrt(dot(across_b, across_b)) * fastest(other, at.offset, b.spin)
    time = horizon
    for i in range(3):
        height, rate = dot(axis, one[i]) - at.flight.aim, drift + dot(across_a, one[i])
        for j in range(3):
            gap = height - dot(axis, other[j])
            if not gap > 0.0:
                return 0.0
            speed = rate - dot(across_b, minus(other[j], at.offset))
            # what is open at both ends is open between them, as the bound is concave
            if not gap + time * (speed - 0.5 * bend * time) > 0.0:
                time = min(time, until_closed(gap, speed, bend, np.inf))
    return time if time < horizon else np.inf


@strict_step
def until_closed(gap: float, rate: float, bend: float, horizon: float) -> float:
    """The time at which gap + rate t - bend t^2 / 2 = 0, or inf if that is beyond the horizon."""
    if gap + horizon * (rate - 0.5 * bend * horizon) > 0.0:
        return np.inf
    root = sqrt(rate * rate + 2.0 * bend * gap)
    return (rate + root) / bend if rate > 0.0 else 2.0 * gap / (root - rate)


@strict_step
def across(axis: Vector, spin: Vector) -> float:
    """The spin about axes at right angles to this one, rad/s."""
    part = cross(axis, spin)
    return sqrt(dot(part, part))


@strict_step
def fastest(triangle: Triangle, centre: Vector, spin: Vector) -> float:
    """Of the corners of a triangle that spins about a centre, m/s."""
    most = 0.0
    for corner in range(3):
        velocity = cross(spin, minus(triangle[corner], centre))
        most = max(most, dot(velocity, velocity))
    return sqrt(most)
