"""The course of every body in a recorded run: where it was, and how fast, whenever its velocity changed.

Between two changes a body flies straight, so that these legs give its place at any time exactly; no frame is sampled.
They are recorded only for a replay; the clocks of such a run include the recording and are not to be used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.motion.hit_states import HitStates
from harness.scene.bodies import Bodies
from harness.scene.box import Box


@dataclass(frozen=True, eq=False)
class Course:
    """Legs in the order of their times; the first n are the starts of the n bodies at time 0.

    Parameters
    ----------
    times : (m,) float array, s, when each leg begins
    bodies : (m,) int array, whose it is
    positions, velocities : (m, 3) float arrays, m and m/s, from its begin on
    quaternions, spins : (m, 4) and (m, 3) rad/s, likewise, where poses were recorded; else a spin never changes
    """

    times: Floats
    bodies: Ints
    positions: Floats
    velocities: Floats
    quaternions: Floats | None = None
    spins: Floats | None = None


class CourseLog:
    """Records the legs of moving bodies.

    Parameters
    ----------
    positions, velocities : (n, 3) float arrays, m and m/s, at time 0
    """

    def __init__(self, positions: Floats, velocities: Floats) -> None:
        self._velocities = velocities.copy()
        self._times = [np.zeros(len(positions))]
        self._bodies: list[Ints] = [np.arange(len(positions))]
        self._positions = [positions.copy()]
        self._speeds = [velocities.copy()]

    def turn(self, time: float, positions: Floats, velocities: Floats) -> None:
        """Begin a leg for every body whose velocity has changed.

        Parameters
        ----------
        time : s
        positions, velocities : (n, 3) float arrays, m and m/s, of all bodies at that time
        """
        changed = np.flatnonzero((velocities != self._velocities).any(axis=1))
        if len(changed):
            self._velocities[changed] = velocities[changed]
            self.begin(time, changed, positions[changed], velocities[changed])

    def begin(self, time: float, bodies: Ints, positions: Floats, velocities: Floats) -> None:
        """Begin a leg for each of these (k,) bodies; positions and velocities are theirs alone, (k, 3)."""
        self._times.append(np.full(len(bodies), time))
        self._bodies.append(bodies)
        self._positions.append(positions.copy())
        self._speeds.append(velocities.copy())

    def add_hits(self, times: Floats, bodies: Pairs, states: HitStates) -> None:
        """Begin a leg for every body that one of these hits, in order, has turned.

        Parameters
        ----------
        times : (k,) float array, s
        bodies : (k, 2) int array; the second is -1 where a wall was hit
        states : HitStates of them
        """
        turned = (bodies >= 0) & (states.velocities_after != states.velocities_before).any(axis=2)
        self._times.append(np.repeat(times, 2).reshape(-1, 2)[turned])
        self._bodies.append(bodies[turned])
        self._positions.append(states.positions[turned])
        self._speeds.append(states.velocities_after[turned])

    def course(self) -> Course:
        """The legs recorded; of several of a body that begin at the same time, the last."""
        times, bodies = np.concatenate(self._times), np.concatenate(self._bodies)
        order = np.lexsort((np.arange(len(times)), bodies, times))
        times, bodies = times[order], bodies[order]
        last = np.append((np.diff(times) != 0) | (np.diff(bodies) != 0), True) if len(times) else np.zeros(0, np.bool_)
        kept = order[last]
        return Course(
            times[last], bodies[last], np.concatenate(self._positions)[kept], np.concatenate(self._speeds)[kept]
        )


def folded_course(bodies: Bodies, box: Box, duration: float) -> Course:
    """The course where only the box reflects: a leg wherever it folds the path of a bounding sphere, in closed form.

    Parameters
    ----------
    bodies : Bodies at time 0
    box : that folds their paths, as in `harness.motion.kinematics`
    duration : s
    """
    inner_half = box.half - bodies.radii[:, None]
    stuck = inner_half <= 0.0  # wider than the box: it stays in the middle
    positions, velocities = np.where(stuck, 0.0, bodies.positions), np.where(stuck, 0.0, bodies.velocities)
    log, since = CourseLog(positions, velocities), np.zeros(len(bodies))
    folds = sorted(
        (float(time), body, axis)
        for body, axis in np.argwhere(velocities != 0.0).tolist()
        for time in _fold_times(positions[body, axis], velocities[body, axis], inner_half[body, axis], duration)
    )
    for time, body, axis in folds:
        positions[body] += velocities[body] * (time - since[body])
        since[body] = time
        if time > 0.0:  # at time 0 it turns where it is
            positions[body, axis] = np.copysign(inner_half[body, axis], velocities[body, axis])
        velocities[body, axis] *= -1.0
        log.begin(time, np.array([body]), positions[[body]], velocities[[body]])
    return log.course()


def _fold_times(x: float, v: float, half: float, duration: float) -> Floats:
    """When a path along one axis meets a wall, s."""
    outward = (x >= half and v > 0.0) or (x <= -half and v < 0.0)
    # one that starts at or beyond a wall and moves on turns at once, and then flies in
    way = abs(x) + half if outward else half - x if v > 0.0 else half + x
    first = float(way / abs(v))
    count = max(0, int(np.floor((duration - first) * abs(v) / (2.0 * half))) + 1)
    later: Floats = first + np.arange(count, dtype=np.float64) * float(2.0 * half / abs(v))
    return np.append(0.0, later) if outward else later
