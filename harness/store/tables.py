"""Reading results: the file turned into a table of runs and into records.

Readers cannot write and never wait for a sweep: each sees every run that had finished when it began to read.
"""

from __future__ import annotations

import json
import math
import sqlite3
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.store.history import reading
from harness.store.records import (
    ComparisonRecord,
    ControlRecord,
    ExperimentRecord,
    PointRow,
    RunRecord,
    SweepRecord,
    VerdictKind,
    VerdictRow,
)
from harness.store.selections import metrics_by_run

if TYPE_CHECKING:
    import pandas as pd

# What is said of a row of `expect` or `claims` that the sweep did not come to judge.
NOT_JUDGED = "not judged yet: the sweep has not come to its end"

_FIXED = ("experiment", "point", "repeat", "status", "reason", "sweep", "timing_grade", "machine")


def runs(path: str | Path, experiments: Iterable[str] | None = None) -> pd.DataFrame:
    """The run table: a row for every experiment, point it lists now, and repeat.

    Parameters
    ----------
    path : the results file
    experiments : names of those to read; None for all

    Returns
    -------
    DataFrame
        As `run_table` makes it, ordered by name, point and repeat. A repeat measured again shows its newest run.

    Raises
    ------
    InputError
        The file is missing, empty, damaged, another program's, or of another schema version.
    """
    return run_table(run_records(path, experiments))


def run_table(records: Iterable[RunRecord]) -> pd.DataFrame:
    """Runs as a table.

    Returns
    -------
    DataFrame
        experiment, point, repeat, status, reason, sweep, timing_grade and machine, a column a leaf or derived
        parameter, and a float column a metric, NaN where a run does not report it. Leaves that are lists or mappings
        are their JSON text, so that they can be grouped by.
    """
    import pandas as pd

    records = list(records)
    parameters = list(dict.fromkeys(leaf for record in records for leaf in record.parameters))
    metrics = list(dict.fromkeys(name for record in records for name in record.metrics))
    columns: dict[str, Any] = {name: [getattr(record, name) for record in records] for name in _FIXED}
    columns |= {leaf: [_leaf(record.parameters.get(leaf)) for record in records] for leaf in parameters}
    columns |= {
        name: pd.Series([record.metrics.get(name, math.nan) for record in records], dtype=float) for name in metrics
    }
    table = pd.DataFrame(columns).astype({"repeat": int, "sweep": int, "timing_grade": bool})
    # columns of a kind side by side: rows of a wide table are chosen at a fraction of the cost
    consolidated: pd.DataFrame = table.copy()
    return consolidated


def run_records(path: str | Path, experiments: Iterable[str] | None = None) -> list[RunRecord]:
    """The rows of `runs` one by one; here a metric that is not a number differs from one that is not reported."""
    with reading(path) as connection:
        chosen = _names(connection) if experiments is None else sorted(set(experiments))
        rows = connection.execute(
            "SELECT current_run.id, name, key, parameters, repeat, status, reason, current_run.sweep, timing_grade, "
            "fingerprint, conditions "
            "FROM experiment_point JOIN experiment ON experiment.id = experiment_point.experiment "
            "JOIN point ON point.id = experiment_point.point JOIN current_run ON current_run.point = point.id "
            "JOIN machine ON machine.id = current_run.machine "
            "WHERE name IN (SELECT value FROM json_each(?)) ORDER BY name, place, repeat",
            (json.dumps(chosen),),
        ).fetchall()
        metrics = metrics_by_run(connection, [run for run, *_ in rows])
    points = {key: json.loads(parameters) for _, _, key, parameters, *_ in rows}
    return [
        RunRecord(
            experiment=name,
            point=key,
            repeat=repeat,
            status=status,
            reason=reason,
            sweep=sweep,
            timing_grade=bool(timing_grade),
            parameters=points[key],
            metrics=metrics[run],
            machine=machine,
            conditions=json.loads(conditions),
        )
        for run, name, key, _, repeat, status, reason, sweep, timing_grade, machine, conditions in rows
    ]


def controls(path: str | Path, experiments: Iterable[str] | None = None) -> list[ControlRecord]:
    """The controls of the points that experiments list now, each beside the newest run of its point and repeat."""
    with reading(path) as connection:
        chosen = _names(connection) if experiments is None else sorted(set(experiments))
        newest: dict[tuple[str, int], ControlRecord] = {}
        for key, repeat, machine, metrics in connection.execute(
            "SELECT DISTINCT key, repeat, fingerprint, metrics FROM control JOIN point ON point.id = control.point "
            "JOIN experiment_point ON experiment_point.point = point.id "
            "JOIN experiment ON experiment.id = experiment_point.experiment "
            "JOIN machine ON machine.id = control.machine "
            "WHERE status = 'ok' AND name IN (SELECT value FROM json_each(?)) ORDER BY control.rowid",
            (json.dumps(chosen),),
        ):
            newest[key, repeat] = ControlRecord(key, repeat, machine, json.loads(metrics))
    return list(newest.values())


def experiments(path: str | Path) -> list[ExperimentRecord]:
    """Every experiment as it was last swept, by name.

    A row of its `expect` or `claims` that the sweep did not judge, since it was stopped, is undecided and says so.
    """
    with reading(path) as connection:
        known = {sweep.id: sweep for sweep in _sweeps(connection)}
        records = []
        for number, name, title, question, source, text, sweep in connection.execute(
            "SELECT id, name, title, question, source, specification, sweep FROM experiment ORDER BY name"
        ).fetchall():
            specification = json.loads(text)
            records.append(
                ExperimentRecord(
                    name=name,
                    title=title,
                    question=question,
                    source=source,
                    specification=specification,
                    points=_points(connection, number),
                    expectations=_verdicts(connection, "expectation", number, sweep, specification.get("expect", ())),
                    claims=_verdicts(connection, "claim", number, sweep, specification.get("claims", ())),
                    sweep=known[sweep],
                )
            )
        return records


def sweeps(path: str | Path) -> list[SweepRecord]:
    """Every sweep, the oldest first."""
    with reading(path) as connection:
        return _sweeps(connection)


def conditions(path: str | Path, experiment: str) -> list[dict[str, float]]:
    """The conditions of each newest run of an experiment: load, frequency and the like by name, while it ran."""
    with reading(path) as connection:
        rows = connection.execute(
            "SELECT conditions FROM current_run JOIN experiment_point ON experiment_point.point = current_run.point "
            "JOIN experiment ON experiment.id = experiment_point.experiment WHERE name = ? ORDER BY current_run.id",
            (experiment,),
        ).fetchall()
    return [json.loads(text) for (text,) in rows]


def machines(path: str | Path) -> dict[str, dict[str, Any]]:
    """The facts of every machine that something ran on, by its fingerprint."""
    with reading(path) as connection:
        rows = connection.execute("SELECT fingerprint, facts FROM machine ORDER BY id").fetchall()
    return {fingerprint: json.loads(facts) for fingerprint, facts in rows}


def comparisons(path: str | Path) -> list[ComparisonRecord]:
    """The newest comparison of every two backends on every experiment, by name."""
    with reading(path) as connection:
        rows = connection.execute(
            "SELECT experiment, first, second, made, command, document FROM comparison "
            "WHERE id IN (SELECT max(id) FROM comparison GROUP BY experiment, first, second) "
            "ORDER BY experiment, first, second"
        ).fetchall()
    return [
        ComparisonRecord(name, (first, second), made, command, json.loads(text))
        for name, first, second, made, command, text in rows
    ]


def _names(connection: sqlite3.Connection) -> list[str]:
    return [name for (name,) in connection.execute("SELECT name FROM experiment ORDER BY name")]


def _points(connection: sqlite3.Connection, experiment: int) -> tuple[PointRow, ...]:
    return tuple(
        PointRow(key, json.loads(parameters), json.loads(plan))
        for key, parameters, plan in connection.execute(
            "SELECT key, parameters, plan FROM experiment_point JOIN point ON point.id = experiment_point.point "
            "WHERE experiment = ? ORDER BY place",
            (experiment,),
        )
    )


def _verdicts(
    connection: sqlite3.Connection, kind: VerdictKind, experiment: int, sweep: int, criteria: Iterable[dict[str, Any]]
) -> tuple[VerdictRow, ...]:
    judged = tuple(
        VerdictRow(json.loads(criterion), verdict, statement, json.loads(detail))
        for criterion, verdict, statement, detail in connection.execute(
            f"SELECT criterion, verdict, statement, detail FROM {kind} "
            "WHERE experiment = ? AND sweep = ? ORDER BY place",
            (experiment, sweep),
        )
    )
    if judged:
        return judged
    return tuple(VerdictRow(row, "undecided", NOT_JUDGED) for row in criteria)


def _sweeps(connection: sqlite3.Connection) -> list[SweepRecord]:
    return [
        SweepRecord(
            number, started, finished, command, commit, version, fingerprint, json.loads(facts), json.loads(packages)
        )
        for number, started, finished, command, commit, version, fingerprint, facts, packages in connection.execute(
            "SELECT sweep.id, started, finished, command, commit_id, version, fingerprint, facts, packages "
            "FROM sweep JOIN machine ON machine.id = sweep.machine ORDER BY sweep.id"
        )
    ]


def _leaf(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, list | dict) else value
