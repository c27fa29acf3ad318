"""Bodies in free flight: where they are at a time, how they are turned, and how fast their points can move."""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

from harness.kernel import kernel
from harness.narrowphase.gjk import Relative, relative_pose
from harness.narrowphase.vectors import Matrix, Vector, cross, dot, minus, plus, rotation, scaled, turned_back


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


class RelativeMotion(NamedTuple):
    """Body b as seen from the centre of body a at an instant; all vectors are in the axes of a.

    Attributes
    ----------
    pose : Relative
    spin_a, spin_b : rad/s
    drift : m/s, velocity of b's centre less that of a's
    """

    pose: Relative
    spin_a: Vector
    spin_b: Vector
    drift: Vector


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


@kernel
def seen_at(a: Motion, b: Motion, time: float) -> tuple[Motion, Motion]:
    """The bodies as seen from the centre of the first, which moves with it, and with this time as 0."""
    offset, velocity, rest = minus(place(b, time), place(a, time)), minus(b.velocity, a.velocity), (0.0, 0.0, 0.0)
    return (
        Motion(rest, rest, attitude(a, time), a.spin, a.size, a.reach),
        Motion(offset, velocity, attitude(b, time), b.spin, b.size, b.reach),
    )


@kernel
def relative_motion(a: Motion, b: Motion, time: float) -> RelativeMotion:
    """How body b moves as seen from body a, of a pair as `seen_at` gives it."""
    turn = orientation(a, time)
    pose = relative_pose(turn, a.size, orientation(b, time), b.size, place(b, time))
    drift = minus(b.velocity, a.velocity)
    return RelativeMotion(pose, turned_back(turn, a.spin), turned_back(turn, b.spin), turned_back(turn, drift))


@kernel
def turning_speed(axis: Vector, body: Motion) -> float:
    """How fast a point of a spinning body can move along an axis that stands still, m/s, besides its flight.

    (w x p).n = p.(n x w), so that only the spin across the axis counts: a body that spins about it closes no gap.
    """
    across = cross(axis, body.spin)
    return sqrt(dot(across, across)) * body.reach


@kernel
def fastest_passing(a: Motion, b: Motion) -> float:
    """At most how fast a point of one body passes one of the other, m/s."""
    drift = minus(b.velocity, a.velocity)
    return sqrt(dot(drift, drift)) + sqrt(dot(a.spin, a.spin)) * a.reach + sqrt(dot(b.spin, b.spin)) * b.reach


@kernel
def speed_of_points(body: Motion) -> float:
    """At most how fast a point of a body moves, m/s."""
    return sqrt(dot(body.velocity, body.velocity)) + sqrt(dot(body.spin, body.spin)) * body.reach
