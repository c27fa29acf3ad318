"""The hits of a run, in the order in which they were answered."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isnan
from typing import Any

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.motion.answers import NearAnswers
from harness.motion.course import Course
from harness.motion.hit_states import HitStates
from harness.vocabulary import WALLS, Query


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
    states : of the bodies of every hit, where they were asked for
    query : what was asked of pairs
    answers : the pairs that were near in every frame that was asked about, of a query about near pairs; frames of
        bodies at rest are all like the first, which alone is asked
    step : s a frame, of such a query
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
    states: HitStates | None = None
    query: Query = "collision"
    answers: NearAnswers | None = None
    step: float = 0.0

    @property
    def gaps(self) -> list[float | None]:
        """m, of the pair of each event at its time; None at walls, and where the query has none."""
        if self.answers is None:
            return [None] * len(self.times)
        answers = self.answers
        keys = zip((answers.frames * self.step).tolist(), *answers.pairs.T.tolist(), strict=True)
        known = dict(zip(keys, answers.gaps.tolist(), strict=True))
        events = zip(self.times.tolist(), *self.bodies.T.tolist(), strict=True)
        return [_gap_or_none(known.get(event)) for event in events]

    def to_json(self) -> dict[str, Any]:
        """The document that `harness trace --json` prints."""
        events: list[dict[str, Any]] = []
        for time, (i, j), wall in zip(self.times.tolist(), self.bodies.tolist(), self.walls.tolist(), strict=True):
            if wall < 0:
                events.append({"time": time, "kind": "near" if self.near else "pair", "bodies": [i, j]})
            else:
                events.append({"time": time, "kind": "wall", "bodies": [i], "wall": WALLS[wall]})
        if self.states is not None:
            for event, states in zip(events, self.states.rows(), strict=True):
                event |= {name: rows[: len(event["bodies"])] for name, rows in states.items()}
        if self.near:
            for event, gap in zip(events, self.gaps, strict=True):
                event |= {} if gap is None else {"gap": gap}
        final = {
            "time": self.time,
            "position": self.positions.tolist(),
            "velocity": self.velocities.tolist(),
            "energy": self.energy,
        }
        return {"events": events, "final": final, "counters": dict(self.counters), **self._found()}

    def _found(self) -> dict[str, Any]:
        """What other queries than collision add: the query, and its answers in full."""
        if self.query == "collision":
            return {}
        if self.answers is not None:
            return {"query": self.query, "near": self._near_rows(self.answers)}
        between = np.flatnonzero(self.walls < 0).tolist()
        impacts = [{"time": float(self.times[k]), "bodies": self.bodies[k].tolist()} for k in between]
        return {"query": self.query, "impacts": impacts}

    def _near_rows(self, answers: NearAnswers) -> list[dict[str, Any]]:
        columns = answers.frames.tolist(), answers.pairs.tolist(), answers.gaps.tolist()
        there: list[bool] = np.asarray(np.isfinite(answers.points).all(axis=(1, 2))).tolist()
        return [
            {
                "frame": frame,
                "time": frame * self.step,
                "bodies": pair,
                "gap": _gap_or_none(gap),
                "points": answers.points[k].tolist() if there[k] else None,
            }
            for k, (frame, pair, gap) in enumerate(zip(*columns, strict=True))
        ]

    def to_csv(self) -> str:
        """The table that `harness trace --csv` prints: a row a hit; what a wall does not have is empty.

        Of "distance" and "tolerance" a row is a pair that comes near, and its last column the gap (m) at that frame.
        """
        states = self.states
        columns = [] if states is None else [(name, getattr(states, name)) for name in _STATE_COLUMNS.values()]
        text = io.StringIO()
        rows = csv.writer(text, lineterminator="\n")
        named = [f"{whose}{name}_{axis}" for whose in ("", "other_") for name in _STATE_COLUMNS for axis in "xyz"]
        rows.writerow(
            ["time", "kind", "body", "other", "wall", *(named if columns else ()), *(["gap"] if self.near else [])]
        )
        gaps = self.gaps
        for k, (time, (i, j), wall) in enumerate(
            zip(self.times.tolist(), self.bodies.tolist(), self.walls.tolist(), strict=True)
        ):
            met = ["near" if self.near else "pair", i, j, ""] if wall < 0 else ["wall", i, "", WALLS[wall]]
            numbers = [number for body in (0, 1) for _, column in columns for number in column[k, body].tolist()]
            gap = ["" if gaps[k] is None else gaps[k]] if self.near else []
            rows.writerow([time, *met, *("" if isnan(number) else number for number in numbers), *gap])
        return text.getvalue()


def _gap_or_none(gap: float | None) -> float | None:
    return None if gap is None or isnan(gap) else gap


# Names of the columns of a table, and of the fields of `HitStates` that they show.
_STATE_COLUMNS = {
    "position": "positions",
    "velocity_before": "velocities_before",
    "velocity_after": "velocities_after",
    "impulse": "impulses",
}


@dataclass(frozen=True)
class Outcome:
    """What a motion reports: metrics by name, and a trace, a course and the answers to its query if asked for."""

    metrics: dict[str, float]
    trace: Trace | None
    course: Course | None = None
    answers: NearAnswers | None = None
