"""How two sweeps differ: which points got faster or slower, which counted or ended otherwise."""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from harness.errors import InputError
from harness.measure.metrics import DERIVED, METRICS
from harness.measure.noise import distinguishable, noise_floor
from harness.measure.statistics import Summary, paired_ratio
from harness.store.records import RunRecord, SweepRecord
from harness.store.snapshot import Snapshot, measuring_sweeps, snapshot
from harness.store.tables import sweeps

CLOCK = "run_seconds"
# Relative. Times of the same work drift by so much from one hour to the next, which no control within a sweep can see.
DRIFT = 0.1
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
    ratio : after / before, paired by repeat
    pace : whether the ratio lies beyond the noise floor; unknown below two pairs of repeats of one machine
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
    points : measured by both, those that differ first
    verdicts : expectations and claims that are judged otherwise
    untouched : points that were not measured again
    """

    before: SweepRecord
    after: SweepRecord
    floor: float
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
        return _difference(known[before], known[after], snapshot(path, before), snapshot(path, after))
    recent = measuring_sweeps(path)[-_RECENT:]
    for late in [after] if after is not None else reversed(recent):
        new = snapshot(path, late)
        for early in [before] if before is not None else _earlier(known, recent, late):
            found = _difference(known[early], known[late], snapshot(path, early), new)
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


def _difference(early: SweepRecord, late: SweepRecord, old: Snapshot, new: Snapshot) -> Difference:
    mine, theirs = _by_parameters(old.runs), _by_parameters(new.runs)
    shared = [key for key in theirs if key in mine]
    again = [key for key in shared if _identity(mine[key]) != _identity(theirs[key])]
    floor = max(DRIFT, _floor(old), _floor(new))
    labels = _labels({key: theirs[key] for key in again})
    points = [_point(labels[key], mine[key], theirs[key], floor) for key in again]
    points.sort(key=lambda point: (not point.changed, point.pace in ("same", "unknown"), -abs(_log(point.ratio))))
    counts = {pace: sum(point.pace == pace for point in points) for pace in ("slower", "faster", "same", "unknown")}
    counts["changed"] = sum(point.changed for point in points)
    return Difference(early, late, floor, tuple(points), tuple(_verdicts(old, new)), len(shared) - len(again), counts)


def _by_parameters(runs: Sequence[RunRecord]) -> dict[str, list[RunRecord]]:
    found: dict[str, list[RunRecord]] = defaultdict(list)
    for run in runs:
        found[json.dumps(dict(run.parameters), sort_keys=True)].append(run)
    return found


def _identity(runs: Sequence[RunRecord]) -> set[tuple[str, int, int]]:
    return {(run.point, run.repeat, run.sweep) for run in runs}


def _point(label: str, old: Sequence[RunRecord], new: Sequence[RunRecord], floor: float) -> PointDifference:
    before, after = _clocks(old), _clocks(new)
    places = sorted(before.keys() & after.keys())
    ratio = paired_ratio([after[place] for place in places], [before[place] for place in places])
    statuses = (_statuses(old), _statuses(new))
    return PointDifference(
        experiment=new[0].experiment or old[0].experiment,
        label=label,
        parameters=new[0].parameters,
        before=_median(before.values()),
        after=_median(after.values()),
        ratio=ratio,
        pace=_pace(ratio, floor),
        counters=_counters(old, new),
        statuses=statuses if statuses[0] != statuses[1] else None,
    )


def _pace(ratio: Summary, floor: float) -> Pace:
    if ratio.n < 2:
        return "unknown"
    if not distinguishable(ratio, floor):
        return "same"
    return "slower" if ratio.median > 1.0 else "faster"


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


def _labels(points: Mapping[str, Sequence[RunRecord]]) -> dict[str, str]:
    """For each point the leaves that differ among those of its experiment."""
    grouped: dict[str, list[str]] = defaultdict(list)
    for key, runs in points.items():
        grouped[runs[0].experiment].append(key)
    labels = {}
    for keys in grouped.values():
        parameters = {key: points[key][0].parameters for key in keys}
        leaves = [
            leaf
            for leaf in parameters[keys[0]]
            if leaf not in DERIVED
            and len({json.dumps(found.get(leaf), sort_keys=True) for found in parameters.values()}) > 1
        ]
        for key in keys:
            labels[key] = ", ".join(f"{leaf} {_short(parameters[key].get(leaf))}" for leaf in leaves)
    return labels


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else value if isinstance(value, str) else json.dumps(value)


def _verdicts(old: Snapshot, new: Snapshot) -> list[VerdictDifference]:
    before = {(row.experiment, row.kind, row.criterion): row.verdict for row in old.verdicts}
    return [
        VerdictDifference(row.experiment, was, row.verdict, row.statement)
        for row in new.verdicts
        if (was := before.get((row.experiment, row.kind, row.criterion))) is not None and was != row.verdict
    ]


def _median(values: Any) -> float:
    ordered = sorted(values)
    if not ordered:
        return math.nan
    half = len(ordered) // 2
    return float(ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2)


def _log(ratio: Summary) -> float:
    return math.log(ratio.median) if ratio.n and 0.0 < ratio.median < math.inf else 0.0


def _listed(known: Mapping[int, SweepRecord]) -> str:
    newest = sorted(known)[-5:]
    return ("…, " if len(known) > len(newest) else "") + ", ".join(map(str, newest)) if newest else "none"
