"""The rows of the database as plain values. JSON columns are the values they stand for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

VerdictKind = Literal["expectation", "claim"]


@dataclass(frozen=True)
class PointRow:
    """One point of an experiment: all leaves and derived values under `parameters`.

    `plan` is its pipeline, {} until it is known: {"stages": [{"name", "kept", "why"}], "warnings": [text]}.
    """

    key: str
    parameters: Mapping[str, Any]
    plan: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class VerdictRow:
    """The verdict on one row of `expect` or `claims`."""

    criterion: Mapping[str, Any]
    verdict: str
    statement: str
    detail: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class SweepRecord:
    """One invocation of `sweep`; times are ISO 8601, UTC; `finished` is None for one that was killed or still runs."""

    id: int
    started: str
    finished: str | None
    command: str
    commit: str | None
    version: str
    fingerprint: str
    machine: Mapping[str, Any]
    packages: Mapping[str, str]


@dataclass(frozen=True)
class ExperimentRecord:
    """An experiment as it was last swept: its points in order, its verdicts, and the sweep that listed it."""

    name: str
    title: str
    question: str | None
    source: str
    specification: Mapping[str, Any]
    points: tuple[PointRow, ...]
    expectations: tuple[VerdictRow, ...]
    claims: tuple[VerdictRow, ...]
    sweep: SweepRecord


@dataclass(frozen=True)
class RunRecord:
    """One run, as a point of one experiment. A metric that was measured and is not a number is NaN here.

    `machine` is the fingerprint of where it ran; `conditions` are load, frequency and the like while it ran.
    """

    experiment: str
    point: str
    repeat: int
    status: str
    reason: str | None
    sweep: int
    timing_grade: bool
    parameters: Mapping[str, Any]
    metrics: Mapping[str, float]
    machine: str = ""
    conditions: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class ControlRecord:
    """The clocks of a control: the run of a point and repeat, done once more."""

    point: str
    repeat: int
    machine: str
    metrics: Mapping[str, float]


@dataclass(frozen=True)
class ComparisonRecord:
    """The newest comparison of two backends on the poses of an experiment."""

    experiment: str
    backends: tuple[str, str]
    made: str
    command: str
    document: Mapping[str, Any]
