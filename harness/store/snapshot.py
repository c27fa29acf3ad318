"""The results as they were when a sweep had ended: the difference of two sweeps is that of their snapshots."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from harness.store.connection import as_input_error
from harness.store.history import reading
from harness.store.records import RunRecord, VerdictKind
from harness.store.selections import EXPERIMENT_OF_POINT, metrics_by_run


@dataclass(frozen=True)
class VerdictRecord:
    """The verdict of a sweep on one row of an experiment's expectations or claims."""

    experiment: str
    kind: VerdictKind
    criterion: str
    verdict: str
    statement: str


@dataclass(frozen=True)
class Snapshot:
    """The results as they were when a sweep had ended.

    Parameters
    ----------
    runs : the newest of every point and repeat that was measured by then. Of points with the same parameters, which
        another version of the program has measured under another key, the one measured last
    controls : by point and repeat, the clocks of the control
    verdicts : of every experiment, those of the newest sweep until then that judged it
    """

    runs: tuple[RunRecord, ...]
    controls: dict[tuple[str, int], dict[str, float]]
    verdicts: tuple[VerdictRecord, ...]


def measuring_sweeps(path: str | Path) -> list[int]:
    """The sweeps that measured something, the oldest first."""
    with reading(path) as connection:
        return [number for (number,) in connection.execute("SELECT DISTINCT sweep FROM run ORDER BY sweep")]


def snapshot(path: str | Path, sweep: int) -> Snapshot:
    """The results as they were when a sweep had ended.

    Raises
    ------
    InputError
        The file is missing, empty, damaged, another program's, or of another schema version.
    """
    with reading(path) as connection, as_input_error(Path(path)):
        rows = connection.execute(
            "SELECT run.id, key, parameters, repeat, status, reason, sweep, timing_grade, fingerprint, "
            f"{EXPERIMENT_OF_POINT} "
            "FROM run JOIN point ON point.id = run.point JOIN machine ON machine.id = run.machine "
            "WHERE run.id IN (SELECT max(id) FROM run WHERE sweep <= ? GROUP BY point, repeat) ORDER BY run.id",
            (sweep,),
        ).fetchall()
        metrics = metrics_by_run(connection, [run for run, *_ in rows])
        controls = {
            (key, repeat): json.loads(clocks)
            for key, repeat, clocks in connection.execute(
                "SELECT key, repeat, metrics FROM control JOIN point ON point.id = control.point "
                "WHERE status = 'ok' AND sweep <= ? ORDER BY sweep",
                (sweep,),
            )
        }
        verdicts = [
            VerdictRecord(name, kind, criterion, verdict, statement)
            for kind in ("expectation", "claim")
            for name, criterion, verdict, statement in connection.execute(
                f"SELECT name, criterion, verdict, statement FROM {kind} AS judged "
                "JOIN experiment ON experiment.id = judged.experiment "
                f"WHERE judged.sweep = (SELECT max(sweep) FROM {kind} WHERE experiment = judged.experiment "
                "AND sweep <= ?) ORDER BY name, place",
                (sweep,),
            )
        ]
    # the last key of the same parameters wins, as the rows come in the order they were measured
    last = {parameters: key for _, key, parameters, *_ in rows}
    runs = tuple(
        RunRecord(
            experiment=name or "",
            point=key,
            repeat=repeat,
            status=status,
            reason=reason,
            sweep=number,
            timing_grade=bool(grade),
            parameters=json.loads(parameters),
            metrics=metrics[run],
            machine=machine,
        )
        for run, key, parameters, repeat, status, reason, number, grade, machine, name in rows
        if last[parameters] == key
    )
    return Snapshot(runs, controls, tuple(verdicts))
