"""How two sweeps differ: which points got faster or slower, which counted or ended otherwise.

A point is called slower where all of this holds:

- five repeats or more are paired, each with the same repeat of the other sweep on the same machine;
- what the machine has drifted between the two is taken out, repeat by repeat: the median ratio of all points;
- the interval of the ratio then lies beyond the noise floor: of either sweep's controls, and 10 % in any case, for a
  process can be that much slower than another of the same program by where its memory happens to lie;
- its p-value, of Student's test that the ratio lies beyond that 10 %, counts among those of all points.

Below five points nothing tells a drift of the machine from a change of the program: then a quarter is allowed for it.
"""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from harness.errors import InputError
from harness.measure.metrics import METRICS
from harness.measure.noise import distinguishable, level, noise_floor, student
from harness.measure.statistics import FEWEST_FOR_INTERVAL, Summary, summary
from harness.report.point_labels import labels_of
from harness.store.records import RunRecord, SweepRecord
from harness.store.snapshot import Snapshot, measuring_sweeps, snapshot
from harness.store.tables import sweeps

CLOCK = "run_seconds"
# Relative. Times of the same work drift by so much from one hour to the next, which no control within a sweep can see.
DRIFT = 0.1
# The same, where there are too few points to see by how much the machine has drifted.
UNKNOWN_DRIFT = 0.25
FEWEST_FOR_DRIFT = 5  # points
# No machine drifts by a larger factor: what all points have in common beyond that is a change of the program.
MOST_DRIFT = 2.0
# Another value is another answer. Errors near rounding are none of them, for a compiler may change those.
EXACT = tuple(name for name, metric in METRICS.items() if metric.exact)

_RECENT = 10  # sweeps among which two are looked for, where none are named

Pace = Literal["slower", "faster", "same", "unknown"]


@dataclass(frozen=True)
class PointDifference:
    """A point that both sweeps have measured.

    Parameters
    ----------
    label : what tells it from the others of its experiment
    before, after : medians of the clock, s; NaN where no run tells
    ratio : after / before, paired by repeat, without the drift of the machine
    pace : whether the ratio is told from 1; unknown below five pairs of repeats of one machine
    counters : {name: (before, after)} of the exact metrics that differ
    statuses : how its runs ended, before and after, where that differs
    """

    experiment: str
    label: str
    parameters: Mapping[str, Any]
    before: float
    after: float
    ratio: Summary
    pace: Pace
    counters: Mapping[str, tuple[float, float]]
    statuses: tuple[str, str] | None

    @property
    def changed(self) -> bool:
        """Whether it gives another answer."""
        return bool(self.counters) or self.statuses is not None


@dataclass(frozen=True)
class VerdictDifference:
    """An expectation or a claim whose verdict is another now."""

    experiment: str
    before: str
    after: str
    statement: str


@dataclass(frozen=True)
class Difference:
    """Two sweeps, and in what they differ.

    Parameters
    ----------
    floor : relative; no smaller difference in time is called one
    drift : by which factor the machine as a whole got slower, taken out of all ratios; None where it cannot be seen
    points : measured by both, those that differ first
    verdicts : expectations and claims that are judged otherwise
    untouched : points that were not measured again
    """

    before: SweepRecord
    after: SweepRecord
    floor: float
    drift: float | None
    points: tuple[PointDifference, ...]
    verdicts: tuple[VerdictDifference, ...]
    untouched: int = 0
    counts: Mapping[str, int] = field(default_factory=dict)

    @property
    def changed(self) -> bool:
        """Whether anything but time differs."""
        return bool(self.verdicts) or any(point.changed for point in self.points)


def difference(path: str | Path, before: int | None = None, after: int | None = None) -> Difference:
    """How the results differ as two sweeps left them.

    Parameters
    ----------
    path : the results file
    before, after : numbers of sweeps. Without, the newest, and the newest before it that measured the same points.

    Raises
    ------
    InputError
        There is no such sweep, or no two that measured the same points.
    """
    known = {sweep.id: sweep for sweep in sweeps(path)}
    for number in (before, after):
        if number is not None and number not in known:
            raise InputError(f"{path}: there is no sweep {number}; there are {_listed(known)}")
    if before is not None and after is not None:
        return difference_of(known[before], known[after], snapshot(path, before), snapshot(path, after))
    recent = measuring_sweeps(path)[-_RECENT:]
    for late in [after] if after is not None else reversed(recent):
        new = snapshot(path, late)
        for early in [before] if before is not None else _earlier(known, recent, late):
            found = difference_of(known[early], known[late], snapshot(path, early), new)
            if found.points:
                return found
    raise InputError(
        f"{path}: no two of its {len(known)} sweeps measured the same points; `harness sweep --fresh` measures again, "
        "and `harness diff SWEEP SWEEP` takes any two"
    )


def _earlier(known: Mapping[int, SweepRecord], recent: Sequence[int], late: int) -> list[int]:
    """Sweeps before another, those that came to their end first, the newest first."""
    numbers = [number for number in sorted(recent, reverse=True) if number < late]
    return sorted(numbers, key=lambda number: known[number].finished is None)


def difference_of(early: SweepRecord, late: SweepRecord, old: Snapshot, new: Snapshot) -> Difference:
    """How results differ that two sweeps left."""
    mine, theirs = _by_parameters(old.runs), _by_parameters(new.runs)
    shared = [key for key in theirs if key in mine]
    again = [key for key in shared if _identity(mine[key]) != _identity(theirs[key])]
    ratios = {key: _ratios(mine[key], theirs[key]) for key in again}
    drifts = _drifts(ratios.values())
    floor = max(UNKNOWN_DRIFT if drifts is None else DRIFT, _floor(old), _floor(new))
    steady = {key: _without(found, drifts or {}) for key, found in ratios.items()}
    paces = _paces(steady, floor, math.log1p(UNKNOWN_DRIFT if drifts is None else DRIFT))
    labels = labels_of({key: (theirs[key][0].experiment, theirs[key][0].parameters) for key in again})
    points = [_point(labels[key], mine[key], theirs[key], summary(steady[key]), paces[key]) for key in again]
    points.sort(key=lambda point: (not point.changed, point.pace in ("same", "unknown"), -abs(_log(point.ratio))))
    counts = {pace: sum(point.pace == pace for point in points) for pace in ("slower", "faster", "same", "unknown")}
    counts["changed"] = sum(point.changed for point in points)
    return Difference(
        early,
        late,
        floor,
        float(np.median(list(drifts.values()))) if drifts else None,
        tuple(points),
        tuple(_verdicts(old, new)),
        len(shared) - len(again),
        counts,
    )


_Ratios = dict[tuple[int, str], float]
"""after / before of one point, by repeat and machine."""


def _ratios(old: Sequence[RunRecord], new: Sequence[RunRecord]) -> _Ratios:
    before, after = _clocks(old), _clocks(new)
    return {place: after[place] / before[place] for place in sorted(before.keys() & after.keys())}


def _drifts(points: Iterable[_Ratios]) -> _Ratios | None:
    """By which factor the machine got slower in every repeat; None where too few points tell.

    A repeat that few points have is given the drift of the others.
    """
    seen: dict[tuple[int, str], list[float]] = defaultdict(list)
    for found in points:
        for place, ratio in found.items():
            seen[place].append(ratio)
    medians = {place: float(np.median(found)) for place, found in seen.items() if len(found) >= FEWEST_FOR_DRIFT}
    if not medians:
        return None
    usual = float(np.median(list(medians.values())))
    return {place: min(max(medians.get(place, usual), 1.0 / MOST_DRIFT), MOST_DRIFT) for place in seen}


def _without(ratios: _Ratios, drifts: _Ratios) -> list[float]:
    return [ratio / drifts.get(place, 1.0) for place, ratio in ratios.items()]


def _paces(points: Mapping[str, Sequence[float]], floor: float, allowed: float) -> dict[str, Pace]:
    """The pace of every point, all of them looked at together.

    Parameters
    ----------
    points : ratios of each without the drift
    floor : relative, of the interval
    allowed : logarithm of the ratio from which on Student's test counts
    """
    p_values = {
        key: student(np.log(ratios), allowed) for key, ratios in points.items() if len(ratios) >= FEWEST_FOR_INTERVAL
    }
    counting = level(list(p_values.values()))
    paces: dict[str, Pace] = {}
    for key, ratios in points.items():
        found = summary(ratios)
        if key not in p_values:
            paces[key] = "unknown"
        elif p_values[key] > counting or not distinguishable(found, floor):
            paces[key] = "same"
        else:
            paces[key] = "slower" if found.median > 1.0 else "faster"
    return paces


def _by_parameters(runs: Sequence[RunRecord]) -> dict[str, list[RunRecord]]:
    found: dict[str, list[RunRecord]] = defaultdict(list)
    for run in runs:
        found[json.dumps(dict(run.parameters), sort_keys=True)].append(run)
    return found


def _identity(runs: Sequence[RunRecord]) -> set[tuple[str, int, int]]:
    return {(run.point, run.repeat, run.sweep) for run in runs}


def _point(
    label: str, old: Sequence[RunRecord], new: Sequence[RunRecord], ratio: Summary, pace: Pace
) -> PointDifference:
    statuses = (_statuses(old), _statuses(new))
    return PointDifference(
        experiment=new[0].experiment or old[0].experiment,
        label=label,
        parameters=new[0].parameters,
        before=_median(_clocks(old).values()),
        after=_median(_clocks(new).values()),
        ratio=ratio,
        pace=pace,
        counters=_counters(old, new),
        statuses=statuses if statuses[0] != statuses[1] else None,
    )


def _clocks(runs: Sequence[RunRecord]) -> dict[tuple[int, str], float]:
    """The clock by repeat and machine, of the runs whose clocks count."""
    return {
        (run.repeat, run.machine): run.metrics[CLOCK]
        for run in runs
        if run.status == "ok" and run.timing_grade and run.metrics.get(CLOCK, 0.0) > 0.0
    }


def _counters(old: Sequence[RunRecord], new: Sequence[RunRecord]) -> dict[str, tuple[float, float]]:
    changed = {}
    for name in EXACT:
        before, after = (sorted({run.metrics[name] for run in runs if name in run.metrics}) for runs in (old, new))
        if before and after and before != after:
            changed[name] = (before[0], after[0]) if before[0] != after[0] else (before[-1], after[-1])
    return changed


def _statuses(runs: Sequence[RunRecord]) -> str:
    return ", ".join(sorted({run.status for run in runs}))


def _floor(results: Snapshot) -> float:
    """The noise floor that the controls of the results tell, 0 without."""
    first, second = [], []
    for run in results.runs:
        control = results.controls.get((run.point, run.repeat), {})
        if CLOCK in run.metrics and CLOCK in control:
            first.append(run.metrics[CLOCK])
            second.append(control[CLOCK])
    return noise_floor(first, second) or 0.0


def _verdicts(old: Snapshot, new: Snapshot) -> list[VerdictDifference]:
    before = {(row.experiment, row.kind, row.criterion): row.verdict for row in old.verdicts}
    return [
        VerdictDifference(row.experiment, was, row.verdict, row.statement)
        for row in new.verdicts
        if (was := before.get((row.experiment, row.kind, row.criterion))) is not None and was != row.verdict
    ]


def _median(values: Iterable[float]) -> float:
    found = list(values)
    return float(np.median(found)) if found else math.nan


def _log(ratio: Summary) -> float:
    return math.log(ratio.median) if ratio.n and 0.0 < ratio.median < math.inf else 0.0


def _listed(known: Mapping[int, SweepRecord]) -> str:
    newest = sorted(known)[-5:]
    return ("…, " if len(known) > len(newest) else "") + ", ".join(map(str, newest)) if newest else "none"
