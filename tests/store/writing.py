"""Writes small sweeps into a results file."""

from __future__ import annotations

from typing import Any

from harness.store.database import Database
from harness.store.records import PointRow

GRID = PointRow("grid-5", {"count": 5, "algorithm": "grid"}, {"stages": [], "warnings": []})
TREE = PointRow("tree-5", {"count": 5, "algorithm": "tree"})


def begin(database: Database, **facts: Any) -> int:
    return database.begin_sweep("harness sweep", "abc123", "0.1.0", {"cores": 2, **facts}, {"numpy": "2.0"})


def listed(database: Database, sweep: int, *points: PointRow, name: str = "first", **specification: Any) -> int:
    return database.list_experiment(sweep, name, "A title", "Why?", "title: A title", specification, points)


def add(database: Database, sweep: int, key: str, repeat: int = 0, status: Any = "ok", **metrics: float) -> None:
    measured = {name: (value, "1") for name, value in metrics.items()}
    database.add_run(sweep, key, repeat, status, None, None, measured, timing_grade=True)
