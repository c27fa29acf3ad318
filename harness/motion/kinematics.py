"""Where bodies are at a time: exact functions of it, nothing integrated.

Between hits a body is at x + v (t - s) with the place x and the time s of its last hit, and turned by exp(w t) q.
Without a response (`none`) only the box reflects, and the path is the straight line folded at the walls.
"""

from __future__ import annotations

from math import cos, floor, sin, sqrt

import numpy as np

from harness.arrays import Flags, Floats, Ints
from harness.kernel import kernel
from harness.scene.bodies import Bodies
from harness.scene.box import Box


class Trajectory:
    """The poses of bodies that fly freely between hits, at any time asked for.

    Parameters
    ----------
    bodies : Bodies
        At time 0; copied, never changed.
    box : Box
    folded : bool
        Whether the box reflects bounding spheres in closed form (`response: none`) instead of by hits.
    turning : bool
        Whether orientations are followed; without, `quaternions` stay those of time 0.

    Attributes
    ----------
    positions : (n, 3) float array, m
    quaternions : (n, 4) float array, w x y z
    velocities : (n, 3) float array, m/s, those that the flight started or was last redirected with
    """

    def __init__(self, bodies: Bodies, box: Box, *, folded: bool, turning: bool) -> None:
        self.positions = bodies.positions.copy()
        self.quaternions = bodies.quaternions.copy()
        self.velocities = bodies.velocities.copy()
        self._spins = bodies.spins
        self._start_quaternions = bodies.quaternions.copy()
        self._origins = bodies.positions.copy()
        self._since = np.zeros(len(bodies))
        self._inner_half = box.half - bodies.radii[:, None]
        self._folded = folded
        self._turning = turning
        self._folds_at_start = np.zeros((len(bodies), 6), np.int64)
        if folded:
            _turn_inward(self._origins, self.velocities, self._inner_half, self._folds_at_start)

    def move_to(self, time: float) -> None:
        """Put every body where it is at `time` (s)."""
        if self._folded:
            _fold(self._origins, self.velocities, self._inner_half, time, self.positions)
        else:
            _fly(self._origins, self.velocities, self._since, time, self.positions)
        if self._turning:
            turn(self._start_quaternions, self._spins, time, self.quaternions)

    def redirect(self, changed: Flags, time: float) -> None:
        """Start the bodies marked in `changed` (n,) afresh from where they are at `time`, with their new velocities."""
        _restart(changed, self.positions, time, self._origins, self._since)

    def folds(self, time: float) -> Ints:
        """(n, 6): how often each folded path has met each of the walls x-, x+, … by `time`."""
        counts: Ints = np.zeros((len(self._since), 6), np.int64)
        _count_folds(self._origins, self.velocities, self._inner_half, time, counts)
        counts += self._folds_at_start
        return counts

    def velocities_at(self, time: float) -> Floats:
        """(n, 3) m/s at `time`; on folded paths they are those after the last fold."""
        velocities: Floats = self.velocities.copy()
        if self._folded:
            folds = self.folds(time) - self._folds_at_start
            velocities[(folds[:, 0::2] + folds[:, 1::2]) % 2 == 1] *= -1.0
        return velocities

    def spins_at(self, time: float) -> Floats:
        """(n, 3) rad/s at `time`: nothing changes them."""
        return self._spins


@kernel
def _fly(origins: Floats, velocities: Floats, since: Floats, time: float, positions: Floats) -> None:
    for i in range(len(since)):
        flown = time - since[i]
        for axis in range(3):
            positions[i, axis] = origins[i, axis] + velocities[i, axis] * flown


@kernel
def _restart(changed: Flags, positions: Floats, time: float, origins: Floats, since: Floats) -> None:
    for i in range(len(since)):
        if changed[i]:
            since[i] = time
            for axis in range(3):
                origins[i, axis] = positions[i, axis]


@kernel
def turn(start: Floats, spins: Floats, time: float, quaternions: Floats) -> None:
    """Orientations (n, 4) at a time, exp(w t) q of those at time 0, written into `quaternions`."""
    for i in range(len(start)):
        x, y, z = spins[i]
        rate = sqrt(x * x + y * y + z * z)
        half_angle = 0.5 * rate * time
        c = cos(half_angle)
        s = sin(half_angle) / rate if rate > 0.0 else 0.0
        x, y, z = s * x, s * y, s * z
        w0, x0, y0, z0 = start[i]
        quaternions[i, 0] = c * w0 - x * x0 - y * y0 - z * z0
        quaternions[i, 1] = c * x0 + x * w0 + y * z0 - z * y0
        quaternions[i, 2] = c * y0 - x * z0 + y * w0 + z * x0
        quaternions[i, 3] = c * z0 + x * y0 - y * x0 + z * w0


@kernel
def _turn_inward(origins: Floats, velocities: Floats, inner_half: Floats, folds: Ints) -> None:
    """A body that starts at or beyond a wall and moves outward meets it at time 0."""
    for i in range(len(origins)):
        for axis in range(3):
            x, v = origins[i, axis], velocities[i, axis]
            if (x >= inner_half[i, axis] and v > 0.0) or (x <= -inner_half[i, axis] and v < 0.0):
                velocities[i, axis] = -v
                folds[i, 2 * axis + (1 if v > 0.0 else 0)] += 1


@kernel
def _fold_axis(x: float, v: float, half: float, time: float) -> float:
    """Triangle wave between -half and half; a body that starts beyond a wall first flies in.

    >>> [_fold_axis(0.0, 1.0, 4.5, time) for time in (4.5, 9.0, 18.0)]
    [4.5, 0.0, 0.0]
    """
    y = x + v * time
    if (x > half and y > half and v <= 0.0) or (x < -half and y < -half and v >= 0.0):
        return y
    if -half <= y <= half:
        return y
    if half <= 0.0:
        return 0.0
    period = 4.0 * half
    phase = float(np.fmod(y + half, period))
    if phase < 0.0:
        phase += period
    return phase - half if phase <= 2.0 * half else 3.0 * half - phase


@kernel
def _folds_axis(x: float, v: float, half: float, time: float) -> float:
    """How many walls a folded path has met after time 0."""
    if v == 0.0 or half <= 0.0:
        return 0.0
    to_first = (half - x) / v if v > 0.0 else (-half - x) / v
    if time < to_first:
        return 0.0
    return 1.0 + floor((time - to_first) * abs(v) / (2.0 * half))


@kernel
def _fold(origins: Floats, velocities: Floats, inner_half: Floats, time: float, positions: Floats) -> None:
    for i in range(len(origins)):
        for axis in range(3):
            positions[i, axis] = _fold_axis(origins[i, axis], velocities[i, axis], inner_half[i, axis], time)


@kernel
def _count_folds(origins: Floats, velocities: Floats, inner_half: Floats, time: float, counts: Ints) -> None:
    """Paths meet the wall ahead of them first, then the two by turns."""
    for i in range(len(origins)):
        for axis in range(3):
            v = velocities[i, axis]
            folds = int(_folds_axis(origins[i, axis], v, inner_half[i, axis], time))
            ahead = 2 * axis + (1 if v > 0.0 else 0)
            behind = 2 * axis + (0 if v > 0.0 else 1)
            counts[i, ahead] = (folds + 1) // 2
            counts[i, behind] = folds // 2
