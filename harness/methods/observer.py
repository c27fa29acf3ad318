"""Measures a stepped run outside of its clocks: hits, contacts, errors, and a log of the hits if asked for.

With a response, a hit is a contact that was answered. Without (`none`), a hit is the onset of touching: the first of
the consecutive frames that see a pair touch.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.measure.conservation import Conservation, energy
from harness.methods.penetration import Penetration
from harness.motion.digest import EventDigest
from harness.motion.hit_states import HitStates
from harness.motion.hits import HitLog, Trace
from harness.motion.kinematics import Trajectory
from harness.scene.scene import Scene


class Observer:
    """Counts hits and contacts, and measures errors, frame by frame.

    Parameters
    ----------
    scene : Scene
    trajectory : Trajectory being stepped
    penetration : measure the depth of overlaps (spheres and hulls only)
    traced : keep every hit in `log`
    """

    def __init__(self, scene: Scene, trajectory: Trajectory, *, penetration: bool, traced: bool) -> None:
        self.pair_hits = self.pair_contacts = self.wall_hits = 0
        self.max_penetration = 0.0
        self.log = HitLog() if traced else None
        self.digest = EventDigest()
        self.conservation = Conservation(scene.bodies)
        self._trajectory = trajectory
        self._masses = scene.bodies.masses
        self._half = scene.box.half
        self._outside = np.zeros(len(scene.bodies), np.bool_)
        self._penetration = Penetration(scene) if penetration else None

    @property
    def escaped(self) -> int:
        """Bodies whose centre was outside the box in some frame."""
        return int(np.count_nonzero(self._outside))

    def trace(
        self, end: float, counters: Mapping[str, float], *, states: HitStates | None = None, near: bool = False
    ) -> Trace | None:
        """All hits and the state at the end, s, to which the trajectory is moved; None where none were kept."""
        if self.log is None:
            return None
        self._trajectory.move_to(end)
        velocities = self._trajectory.velocities_at(end)
        return Trace(
            *self.log.arrays(),
            time=end,
            positions=self._trajectory.positions.copy(),
            velocities=velocities,
            energy=energy(velocities, self._masses),
            counters=counters,
            states=states,
            near=near,
        )

    def frame(self, time: float, pairs: Pairs, hits: Flags, walls: Ints | Flags, times: Floats | None = None) -> None:
        """Observe one frame.

        Parameters
        ----------
        time : s
        pairs : (k, 2) int array, touching
        hits : (k,) bool array, which of them count as hits
        walls : (n, 6) int or bool array, how often which body hit which wall
        times : (k,) s, when the pairs were hit, ascending; without, all at the frame
        """
        if len(pairs):
            answered = pairs[hits]
            self.pair_hits += len(answered)
            self.pair_contacts += len(pairs) - len(answered)
            if len(answered):
                self.digest.add_pairs(time, answered)
            if self._penetration is not None:
                self.max_penetration = self._penetration.deepest(
                    pairs, self._trajectory.positions, self._trajectory.quaternions, self.max_penetration
                )
            if self.log is not None:
                if times is None:
                    self.log.add_pairs(time, answered)
                else:
                    for hit, pair in zip(times[hits].tolist(), answered, strict=True):
                        self.log.add_pairs(hit, pair[None])
        wall_hits = int(walls.sum())
        if wall_hits:
            self.wall_hits += wall_hits
            self.digest.add_walls(time, walls)
            if self.log is not None:
                self.log.add_walls(time, walls)
        self._outside |= (np.abs(self._trajectory.positions) > self._half).any(axis=1)
        self.conservation.observe(self._trajectory.velocities)

    def repeat(self, pairs: Pairs, times: int) -> None:
        """Count frames that are equal to the last one, in which no pair was answered."""
        self.pair_contacts += times * len(pairs)


def conserved(observer: Observer) -> dict[str, float]:
    """What the motion ought to keep: its energy, and every body in the box; of recorded poses neither is known."""
    return {"energy_drift": observer.conservation.energy_drift, "escaped": float(observer.escaped)}


class Folds:
    """Counts the walls that the folded paths have met since the frame before."""

    def __init__(self, trajectory: Trajectory) -> None:
        self._trajectory = trajectory
        self._before = np.zeros((len(trajectory.positions), 6), np.int64)

    def by(self, time: float) -> Ints:
        """(n, 6) int array: how often which wall, up to the frame at `time` (s)."""
        folds = self._trajectory.folds(time)
        new = folds - self._before
        self._before = folds
        return new


class OnsetFinder:
    """Finds the touching pairs that did not touch in the frame before."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._before = np.empty(0, np.int64)

    def of(self, pairs: Pairs) -> Flags:
        """(k,) bool array for the (k, 2) pairs of the next frame, sorted."""
        numbers = pairs[:, 0] * self._count + pairs[:, 1]
        # both ascend, as pairs are sorted: looked up in a tenth of the time that isin takes
        new: Flags = np.ones(len(numbers), np.bool_)
        if len(self._before):
            places = np.minimum(self._before.searchsorted(numbers), len(self._before) - 1)
            new = self._before[places] != numbers
        self._before = numbers
        return new
