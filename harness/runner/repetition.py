"""Warm a scene before it is timed, and fly a short one again until its clocks mean something.

The first flight of a process is slower than later ones: it reads code and touches memory for the first time, twice as
slow for methods that run in a few kernels and hardly at all for those that call a library for every pair. So the
beginning of the scene is flown outside of every clock, by the same rule for every method: as long as a short sample
takes, and no longer than the whole scene.

What a run has loaded for itself is still touched for the first time in its first flight, and a run of a few
microseconds is mostly noise of the clock besides. So all but long runs are flown again, in their own process, with the
backend as it was loaded, once and until the sample is long enough. Clocks are then means over all flights but the
first; everything else, counters above all, is what the first flight has counted.

Only the first is observed. What observes a frame is outside of the clocks, and yet they see it: it takes the place of
the method's data in the caches, and frames of 10 to 150 µs took up to three times as long for it, those of 0.3 ms up to
1.2 times, those of 1 ms no longer. So a first flight counts only where its frames are long.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from statistics import fmean, harmonic_mean
from time import perf_counter, process_time

from harness.measure.metrics import METRICS
from harness.motion.hits import Outcome
from harness.motion.law import MotionLaw

LONG_ENOUGH = 0.01  # s of CPU time in the motion loop
COLD_UNTIL = 0.1  # s of CPU time from which on a first flight counts: little of it is what later ones take less
LONG_FRAME = 1e-3  # s of CPU time a frame from which on it does not matter to the clocks that it is observed
FIRST_PART = 1 / 64  # of the scene, which the first flight that warms flies
MOST_WARMING = 16  # flights that warm, of which the last ten are whole
MOST_ELAPSED = 0.02  # s that the flights after the first may take with all that is around their loops


def warm(fly: Callable[[MotionLaw], object], law: MotionLaw) -> int:
    """Fly the beginning of a scene, twice as much of it each time, until that has taken as long as a sample must.

    Parameters
    ----------
    fly : one flight from the start, which nobody observes, under a law that may end sooner
    law : of the run

    Returns
    -------
    int
        How many flights there were: of a scene with frames of a second each, one of a single frame.
    """
    began = process_time()
    flights = 0
    while flights < MOST_WARMING and process_time() - began < LONG_ENOUGH:
        fly(law.beginning(min(1.0, 2.0**flights * FIRST_PART)))
        flights += 1
    return flights


def fly_long_enough(fly: Callable[[], Outcome], again: Callable[[], Outcome]) -> tuple[Outcome, int]:
    """Fly as often as it takes.

    Parameters
    ----------
    fly : one flight of a scene from its start
    again : the same flight, for its clocks alone

    Returns
    -------
    Outcome
        Of the first flight, its clocks replaced by means over those that follow, where there are any.
    int
        How many there were.
    """
    first = fly()
    # what computes events has no frames, and is observed a few times
    if first.metrics["run_seconds"] >= max(COLD_UNTIL, LONG_FRAME * first.metrics.get("frames", 0.0)):
        return first, 1
    began, sampled = perf_counter(), 0.0
    later: list[Outcome] = []
    while sampled < LONG_ENOUGH and perf_counter() - began < MOST_ELAPSED:
        later.append(again())
        sampled += later[-1].metrics["run_seconds"]
    means = {name: _mean(name, later) for name in first.metrics if METRICS[name].clock}
    return replace(first, metrics=first.metrics | means), 1 + len(later)


def _mean(name: str, outcomes: list[Outcome]) -> float:
    """The mean over the flights that report the clock: of a rate, the rate of the mean time."""
    values = [outcome.metrics[name] for outcome in outcomes if name in outcome.metrics]
    return harmonic_mean(values) if METRICS[name].unit.endswith("/s") else fmean(values)
