"""What two free runs of the same scene have in common: all hits up to the first that differs, then only averages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.measure.conservation import energy
from harness.motion.hits import Trace
from harness.scene.scene import Scene


@dataclass(frozen=True)
class AfterDivergence:
    """One backend's run, from the divergence to its end, or all of it where there is none.

    Parameters
    ----------
    pair_hits_per_second, box_hits_per_second : 1/s of simulated time
    energy_change : of the translational energy, relative to the start of the run
    """

    backend: str
    pair_hits_per_second: float
    box_hits_per_second: float
    energy_change: float


@dataclass(frozen=True)
class FreeRunPair:
    """Two runs of one scene, each by the hits of its own backend.

    Parameters
    ----------
    bodies, shape, response, duration : of the scene; s
    diverged : s, when the first hit was answered that the other did not answer; None if they are the same to the end
    shared_hits : answered by both before that
    afterwards : of each
    """

    backends: tuple[str, str]
    shape: str
    bodies: int
    response: str
    duration: float
    diverged: float | None
    shared_hits: int
    afterwards: tuple[AfterDivergence, AfterDivergence]


def compare_runs(names: tuple[str, str], scene: Scene, response: str, traces: tuple[Trace, Trace]) -> FreeRunPair:
    """Hold two runs of a scene against each other, in the order of the names."""
    events = [_events(trace) for trace in traces]
    shortest = min(map(len, events))
    differing = (events[0][:shortest] != events[1][:shortest]).any(axis=1)
    shared = int(differing.argmax()) if differing.any() else shortest
    following = [float(rows[shared, 0]) for rows in events if len(rows) > shared]
    diverged = min(following) if following else None
    duration = traces[0].time
    start = float(energy(scene.bodies.velocities, scene.bodies.masses))
    first, second = (
        _afterwards(name, trace, shared if diverged is not None else 0, diverged or 0.0, start)
        for name, trace in zip(names, traces, strict=True)
    )
    return FreeRunPair(
        names,
        scene.shape,
        bodies=len(scene.bodies),
        response=response,
        duration=duration,
        diverged=diverged,
        shared_hits=shared,
        afterwards=(first, second),
    )


def _events(trace: Trace) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Rows of time, bodies and wall."""
    return np.column_stack([trace.times, trace.bodies, trace.walls]).astype(np.float64).reshape(-1, 4)


def _afterwards(name: str, trace: Trace, shared: int, since: float, start: float) -> AfterDivergence:
    seconds = trace.time - since
    pairs = int(np.count_nonzero(trace.walls[shared:] < 0))
    walls = len(trace.walls) - shared - pairs
    change = (trace.energy - start) / start if start else 0.0
    return AfterDivergence(
        name, pairs / seconds if seconds > 0 else 0.0, walls / seconds if seconds > 0 else 0.0, change
    )  # fmt: skip
