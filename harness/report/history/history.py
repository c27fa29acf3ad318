"""A metric over all sweeps of each machine, and the steps in it: where a point got slower or faster for good.

Clocks are compared as logarithms, and what all points of two neighbouring sweeps have in common, up to a factor of two,
is taken for a drift of the machine and taken out, as in the difference of two sweeps. A step is named where two sweeps
or more lie on either side of it, it is larger than 10 %, and its p-value counts among those of all points. In simulated
histories of nothing but noise fewer than one in twenty names any (tests/measure/test_steps.py). Counts
that are exact have no noise: every change of one is a step.
"""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.measure.metrics import METRICS
from harness.measure.noise import level
from harness.measure.statistics import Summary, summary
from harness.measure.steps import candidates, common_noise
from harness.report.point_labels import labels_of
from harness.report.sweeps.difference import CLOCK, DRIFT, FEWEST_FOR_DRIFT, MOST_DRIFT
from harness.store.past import PastRun, past_runs
from harness.store.records import SweepRecord
from harness.store.tables import machines, sweeps

FEWEST_SWEEPS = 4
"""Below so many sweeps of a point no step can be told: two have to lie on either side."""


@dataclass(frozen=True)
class Step:
    """A change for good.

    Parameters
    ----------
    sweep : the first with the new level
    before : the last with the old one
    ratio : new level / old level, without the drift of the machine
    p_value : 0 for exact counts
    """

    sweep: SweepRecord
    before: SweepRecord
    ratio: float
    p_value: float


@dataclass(frozen=True)
class PointHistory:
    """A point over the sweeps that measured it.

    Parameters
    ----------
    label : what tells it from the other points of its experiment
    values : by the number of the sweep, in the order of time
    """

    experiment: str
    label: str
    parameters: Mapping[str, Any]
    values: Mapping[int, Summary]
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class MachineHistory:
    """All points that a machine has measured.

    Parameters
    ----------
    facts : of the machine
    sweeps : that measured the metric, in the order of time
    drifts : by the number of the sweep, the drift of the machine since the first; none of a sweep that shares too few
        points with all before it, and {} where the metric is no clock
    points : those with steps first
    """

    fingerprint: str
    facts: Mapping[str, Any]
    sweeps: tuple[SweepRecord, ...]
    drifts: Mapping[int, float]
    points: tuple[PointHistory, ...]

    @property
    def steps(self) -> list[tuple[PointHistory, Step]]:
        """All of them, the newest first."""
        found = [(point, step) for point in self.points for step in point.steps]
        return sorted(found, key=lambda entry: (-entry[1].sweep.id, -abs(math.log(entry[1].ratio or 1.0))))


def history(path: str | Path, metric: str = CLOCK, experiments: Sequence[str] = ()) -> list[MachineHistory]:
    """The history of every machine.

    Parameters
    ----------
    path : the results file
    experiments : names of those to look at; empty for all

    Raises
    ------
    InputError
        The results cannot be read, or there is no such metric or experiment.
    """
    if metric not in METRICS:
        raise InputError(f'there is no metric "{metric}"; `harness list` says which there are')
    runs = past_runs(path, metric)
    unknown = sorted(set(experiments) - {run.experiment for run in runs})
    if unknown:
        raise InputError(f'{path}: no run of experiment "{unknown[0]}" reports {metric}')
    known, facts = {sweep.id: sweep for sweep in sweeps(path)}, machines(path)
    by_machine: dict[str, list[PastRun]] = defaultdict(list)
    for run in runs:
        if (run.timing_grade or not METRICS[metric].clock) and (not experiments or run.experiment in experiments):
            by_machine[run.machine].append(run)
    return [_machine(name, facts[name], found, known, metric) for name, found in by_machine.items()]


def _machine(
    fingerprint: str, facts: Mapping[str, Any], runs: Sequence[PastRun], known: Mapping[int, SweepRecord], metric: str
) -> MachineHistory:
    measured: dict[str, dict[int, list[float]]] = defaultdict(lambda: defaultdict(list))
    of_point: dict[str, PastRun] = {}
    for run in runs:
        key = json.dumps(dict(run.parameters), sort_keys=True)
        of_point[key] = run
        measured[key][run.sweep].append(run.value)
    numbers = sorted({run.sweep for run in runs})
    values = {key: {number: summary(found[number]) for number in sorted(found)} for key, found in measured.items()}
    drifts: dict[int, float] = {}
    if METRICS[metric].exact:
        steps = {key: _changes(found, known) for key, found in values.items()}
    elif METRICS[metric].clock:
        drifts = _drifts(numbers, values)
        steps = _steps(values, drifts, known)
    else:
        steps = _steps(values, dict.fromkeys(numbers, 1.0), known)
    labels = labels_of({key: (run.experiment, run.parameters) for key, run in of_point.items()})
    points = [
        PointHistory(run.experiment, labels[key], run.parameters, values[key], tuple(steps.get(key, ())))
        for key, run in of_point.items()
    ]
    points.sort(key=lambda point: (not point.steps, point.experiment))
    return MachineHistory(fingerprint, facts, tuple(known[number] for number in numbers), drifts, tuple(points))


def _drifts(numbers: Sequence[int], values: Mapping[str, Mapping[int, Summary]]) -> dict[int, float]:
    """How many times as long as in the first sweep all points took, from one sweep to the next that shares points."""
    drifts = dict.fromkeys(numbers[:1], 1.0)
    for number in numbers[1:]:
        for earlier in reversed(list(drifts)):
            ratios = [
                found[number].median / found[earlier].median
                for found in values.values()
                if number in found and earlier in found and found[earlier].median > 0.0 < found[number].median
            ]
            if len(ratios) >= FEWEST_FOR_DRIFT:
                ratio = float(np.median(ratios))
                drifts[number] = drifts[earlier] * min(max(ratio, 1.0 / MOST_DRIFT), MOST_DRIFT)
                break
    return drifts


def _steps(
    values: Mapping[str, Mapping[int, Summary]], drifts: Mapping[int, float], known: Mapping[int, SweepRecord]
) -> dict[str, list[Step]]:
    """The steps of all points, looked at together."""
    series = {
        key: [math.log(found[number].median / drifts.get(number, 1.0)) for number in found]
        for key, found in values.items()
        if len(found) >= FEWEST_SWEEPS and all(entry.median > 0.0 for entry in found.values())
    }
    common = common_noise(list(series.values()))
    found = {key: candidates(logs, common, math.log1p(DRIFT)) for key, logs in series.items()}
    # a point in which nothing stands out was looked at as well
    counting = level([p for steps in found.values() for p in [step.p_value for step in steps] or [1.0]])
    named: dict[str, list[Step]] = {}
    for key, steps in found.items():
        numbers = list(values[key])
        named[key] = [
            Step(known[numbers[step.place]], known[numbers[step.place - 1]], math.exp(step.change), step.p_value)
            for step in steps
            if step.p_value <= counting
        ]
    return named


def _changes(values: Mapping[int, Summary], known: Mapping[int, SweepRecord]) -> list[Step]:
    """Every change of an exact count."""
    numbers = list(values)
    return [
        Step(known[after], known[before], values[after].median / values[before].median, 0.0)
        if values[before].median
        else Step(known[after], known[before], math.inf, 0.0)
        for before, after in pairwise(numbers)
        if values[before].median != values[after].median
    ]


def package_changes(sweep: SweepRecord, before: SweepRecord | None) -> list[str]:
    """The packages that both sweeps had in other versions: "numpy 2.0 → 2.1"."""
    if before is None:
        return []
    return [
        f"{name} {before.packages[name]} → {version}"
        for name, version in sorted(sweep.packages.items())
        if before.packages.get(name, version) != version
    ]
