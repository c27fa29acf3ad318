"""Rows of `expect` and `claims`, and tables of runs to judge them by."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from harness.measure.verdicts import Kind, Verdict, verdict_on


@dataclass(frozen=True)
class Within:
    of: float
    relative: float


@dataclass(frozen=True)
class Row:
    """A criterion as an experiment file declares it."""

    metric: str
    where: Mapping[str, Any] = field(default_factory=dict)
    at_most: float | None = None
    at_least: float | None = None
    equals: float | None = None
    between: tuple[float, float] | None = None
    within: Within | None = None
    exponent_of: str | None = None
    ratio_to: Mapping[str, Any] | None = None


def table(*points: Mapping[str, Any]) -> pd.DataFrame:
    """A run table: points with leaves and, for each metric, a list with a value a repeat; "lost" are failed ones."""
    rows = []
    for number, point in enumerate(points):
        leaves = {name: value for name, value in point.items() if not isinstance(value, list)}
        metrics = {name: value for name, value in point.items() if isinstance(value, list) and name != "lost"}
        for repeat in range(max(map(len, metrics.values()))):
            ok = repeat not in point.get("lost", ())
            rows.append(
                {"experiment": "e", "point": f"p{number}", "repeat": repeat, "status": "ok" if ok else "timeout"}
                | {"reason": None if ok else "exceeded 120 s", "sweep": 1, "timing_grade": True}
                | leaves
                | {name: values[repeat] if ok else math.nan for name, values in metrics.items()}
            )
    made: pd.DataFrame = pd.DataFrame(rows)
    return made


def judged(row: Row, runs: pd.DataFrame, *swept: str, kind: Kind = "claim") -> Verdict:
    verdict = verdict_on(row, runs, swept, kind)
    json.dumps(verdict.detail, allow_nan=False)
    assert verdict.statement
    return verdict


def expected(row: Row, runs: pd.DataFrame, *swept: str) -> Verdict:
    return judged(row, runs, *swept, kind="expectation")


def counted(power: float, counts: Sequence[int] = (5, 10, 20, 40), **leaves: Any) -> list[dict[str, Any]]:
    return [{"count": count, **leaves, "pair_tests": [3.0 * count**power] * 2} for count in counts]


# Expectations
