"""Rows of `expect` and `claims` as the database keeps them, read again as criteria."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import pandas as pd

from harness.measure.limits import Criterion
from harness.measure.verdicts import expected_refusals
from harness.store.records import ExperimentRecord

_CONDITIONS = ("at_most", "at_least", "equals", "between", "exponent_of", "ratio_to")


def as_criterion(row: Mapping[str, Any]) -> Criterion:
    """A stored row in the form that its limits are read from."""
    within = row.get("within")
    found: Any = SimpleNamespace(
        metric=row["metric"],
        where=row.get("where") or {},
        within=SimpleNamespace(**within) if within else None,
        **{name: row.get(name) for name in _CONDITIONS},
    )
    criterion: Criterion = found
    return criterion


def refusals(record: ExperimentRecord, runs: pd.DataFrame) -> int:
    """How many runs of an experiment were rejected as it expects: they did not fail."""
    return len(expected_refusals([as_criterion(row.criterion) for row in record.expectations], runs))
