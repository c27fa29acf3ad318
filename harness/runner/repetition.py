"""Fly a short scene again until its clocks mean something.

A run of a few microseconds is mostly noise: of the clock, of caches, of the first touch of memory. It is flown again in
its own process, with the backend as it was loaded, until the sample is long enough. Clocks are then means over all
flights; everything else, counters above all, is what the first flight alone has counted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from statistics import fmean, harmonic_mean
from time import perf_counter

from harness.measure.metrics import METRICS
from harness.motion.hits import Outcome

LONG_ENOUGH = 0.01  # s of CPU time in the motion loop
MOST_ELAPSED = 0.02  # s that the flights after the first may take with all that is around their loops


def fly_long_enough(fly: Callable[[], Outcome]) -> tuple[Outcome, int]:
    """Fly as often as it takes.

    Parameters
    ----------
    fly : one flight of the same scene from its start

    Returns
    -------
    Outcome
        Of the first flight, its clocks replaced by means over all flights.
    int
        How many there were.
    """
    outcomes = [fly()]
    began = perf_counter()
    sampled = outcomes[0].metrics["run_seconds"]
    while sampled < LONG_ENOUGH and perf_counter() - began < MOST_ELAPSED:
        outcomes.append(fly())
        sampled += outcomes[-1].metrics["run_seconds"]
    first = outcomes[0]
    if len(outcomes) == 1:
        return first, 1
    means = {name: _mean(name, outcomes) for name in first.metrics if METRICS[name].clock}
    return replace(first, metrics=first.metrics | means), len(outcomes)


def _mean(name: str, outcomes: list[Outcome]) -> float:
    """The mean over the flights that report the clock: of a rate, the rate of the mean time."""
    values = [outcome.metrics[name] for outcome in outcomes if name in outcome.metrics]
    return harmonic_mean(values) if METRICS[name].unit.endswith("/s") else fmean(values)
