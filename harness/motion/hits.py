"""The hits of a run, in the order in which they were answered."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.motion.answers import NearAnswers
from harness.motion.course import Course
from harness.vocabulary import WALLS


@dataclass
class HitLog:
    """Hits appended frame by frame: a pair of bodies, or a body and a wall (then `second` is -1 - wall)."""

    times: list[float] = field(default_factory=list)
    first: list[int] = field(default_factory=list)
    second: list[int] = field(default_factory=list)

    def add_pairs(self, time: float, pairs: Pairs) -> None:
        """Append answered pairs, (k, 2), in order."""
        for i, j in pairs.tolist():
            self.times.append(time)
            self.first.append(i)
            self.second.append(j)

    def add_walls(self, time: float, hits: Ints | Flags) -> None:
        """Append wall hits, (n, 6) how often which body hit which wall, wall after wall."""
        for wall, body in np.argwhere(hits.T).tolist():
            for _ in range(int(hits[body, wall])):
                self.times.append(time)
                self.first.append(body)
                self.second.append(-1 - wall)

    def arrays(self) -> tuple[Floats, Pairs, Ints]:
        """Times (k,), bodies (k, 2) and walls (k,) as in `Trace`."""
        second = np.array(self.second, np.int64)
        bodies = np.column_stack([np.array(self.first, np.int64), np.maximum(second, -1)])
        return np.array(self.times, np.float64), bodies, np.where(second < 0, -1 - second, -1)


@dataclass(frozen=True, eq=False)
class Trace:
    """The events of one run and the state it ended in.

    Parameters
    ----------
    times : (k,) float array, s
    bodies : (k, 2) int array; the second is -1 where a wall was hit
    walls : (k,) int array, number in `WALLS`, -1 where two bodies met
    time : s, when the run ended
    positions, velocities : (n, 3) float arrays at that time, m and m/s
    energy : J, translational, at that time
    counters : of the run
    near : whether a pair's event is that it came near, which is not asked whether they touch
    """

    times: Floats
    bodies: Pairs
    walls: Ints
    time: float
    positions: Floats
    velocities: Floats
    energy: float
    counters: Mapping[str, float]
    near: bool = False

    def to_json(self) -> dict[str, Any]:
        """The document that `harness trace --json` prints."""
        events: list[dict[str, Any]] = []
        for time, (i, j), wall in zip(self.times.tolist(), self.bodies.tolist(), self.walls.tolist(), strict=True):
            if wall < 0:
                events.append({"time": time, "kind": "near" if self.near else "pair", "bodies": [i, j]})
            else:
                events.append({"time": time, "kind": "wall", "bodies": [i], "wall": WALLS[wall]})
        final = {
            "time": self.time,
            "position": self.positions.tolist(),
            "velocity": self.velocities.tolist(),
            "energy": self.energy,
        }
        return {"events": events, "final": final, "counters": dict(self.counters)}


@dataclass(frozen=True)
class Outcome:
    """What a motion reports: metrics by name, and a trace, a course and the answers to its query if asked for."""

    metrics: dict[str, float]
    trace: Trace | None
    course: Course | None = None
    answers: NearAnswers | None = None
