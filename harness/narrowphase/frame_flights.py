"""How bodies move from one frame to the next where only the box reflects them: straight, from wall to wall."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.kernel import inner
from harness.narrowphase.free_flight import Motion, attitude


class FrameFlights(NamedTuple):
    """The motion of n bodies during a frame.

    Attributes
    ----------
    positions : (n, 3) float array, m, at its start
    quaternions : (n, 4) float array, unit, w x y z, at its start
    velocities : (n, 3) float array, m/s, at its start
    spins : (n, 3) float array, rad/s, in the world
    inner_half : (n, 3) float array, m, how far from the middle of the box each centre can come; inf without a box
    sizes : (n,) float array, m
    reach : of size, the farthest that a point of a body is from its centre
    duration : s
    known : s, for how long bodies go on so but for walls; inf, or the duration if the next frame is another motion
    """

    positions: Floats
    quaternions: Floats
    velocities: Floats
    spins: Floats
    inner_half: Floats
    sizes: Floats
    reach: float
    duration: float
    known: float


class PairFlight(NamedTuple):
    """Two bodies on a straight piece of their way.

    Attributes
    ----------
    positions, velocities : (2, 3) float arrays, m and m/s, at its start, written as the piece is left
    """

    positions: Floats
    velocities: Floats


@inner
def flight_of_pair(flights: FrameFlights, i: int, j: int, pair: PairFlight) -> None:
    """Put a pair where it is at the start of the frame; a body as wide as the box stays in the middle."""
    for side in range(2):
        body = i if side == 0 else j
        for axis in range(3):
            free = flights.inner_half[body, axis] > 0.0
            pair.positions[side, axis] = flights.positions[body, axis] if free else 0.0
            pair.velocities[side, axis] = flights.velocities[body, axis] if free else 0.0


@inner
def until_fold(flights: FrameFlights, i: int, j: int, pair: PairFlight) -> float:
    """How long the way of both bodies is straight, s."""
    wait = flights.known
    for side in range(2):
        body = i if side == 0 else j
        for axis in range(3):
            v = pair.velocities[side, axis]
            if v != 0.0:
                ahead = flights.inner_half[body, axis] if v > 0.0 else -flights.inner_half[body, axis]
                wait = min(wait, max((ahead - pair.positions[side, axis]) / v, 0.0))
    return wait


@inner
def fold(flights: FrameFlights, i: int, j: int, pair: PairFlight, wait: float) -> None:
    """Move a pair to the end of its straight piece, and turn who is at a wall then."""
    for side in range(2):
        body = i if side == 0 else j
        for axis in range(3):
            v = pair.velocities[side, axis]
            ahead = flights.inner_half[body, axis] if v > 0.0 else -flights.inner_half[body, axis]
            if v != 0.0 and max((ahead - pair.positions[side, axis]) / v, 0.0) <= wait:
                pair.positions[side, axis] = ahead
                pair.velocities[side, axis] = -v
            else:
                pair.positions[side, axis] += v * wait


@inner
def motion_in(flights: FrameFlights, body: int, pair: PairFlight, side: int, now: float) -> Motion:
    """A body's motion on its straight piece, which begins at a time of the frame, s."""
    x, v, q, w = pair.positions, pair.velocities, flights.quaternions, flights.spins
    size = flights.sizes[body]
    start = Motion(
        (x[side, 0], x[side, 1], x[side, 2]),
        (v[side, 0], v[side, 1], v[side, 2]),
        (q[body, 0], q[body, 1], q[body, 2], q[body, 3]),
        (w[body, 0], w[body, 1], w[body, 2]),
        size,
        size * flights.reach,
    )
    if now == 0.0:
        return start
    return Motion(start.position, start.velocity, attitude(start, now), start.spin, start.size, start.reach)


@inner
def pair_flight() -> PairFlight:
    """Uninitialised."""
    return PairFlight(np.empty((2, 3)), np.empty((2, 3)))
