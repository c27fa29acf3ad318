"""What several readers of the results file select in the same way."""

from __future__ import annotations

import json
import math
import sqlite3
from collections import defaultdict
from collections.abc import Iterable

EXPERIMENT_OF_POINT = (
    "(SELECT min(name) FROM experiment_point JOIN experiment ON experiment.id = experiment_point.experiment "
    "WHERE experiment_point.point = point.id)"
)
"""The name of an experiment that lists the point of a row now, NULL where none does."""


def metrics_by_run(connection: sqlite3.Connection, runs: Iterable[int]) -> dict[int, dict[str, float]]:
    """By the number of a run its metrics, as they were written; NaN is one that is no number."""
    metrics: dict[int, dict[str, float]] = defaultdict(dict)
    for run, name, value in connection.execute(
        "SELECT run, name, value FROM metric WHERE run IN (SELECT value FROM json_each(?)) ORDER BY metric.rowid",
        (json.dumps(list(runs)),),
    ):
        metrics[run][name] = math.nan if value is None else value
    return metrics
