"""Writing measurements: the sweeping process alone adds to the results file.

Every method is one transaction. Measurements are added, never changed or removed; the points and the verdicts of an
experiment are those of its newest sweep.
"""

from __future__ import annotations

import hashlib
import json
import os
import sqlite3
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime, timezone
from pathlib import Path
from types import TracebackType
from typing import Any

from harness.errors import InputError
from harness.store.connection import as_input_error, open_for_writing
from harness.store.history import History
from harness.store.lock import SweepLock
from harness.store.recording import Recording, recorded, write
from harness.store.records import PointRow, VerdictKind, VerdictRow
from harness.vocabulary import Status


class Database:
    """The results file, open for writing by this process alone: a child forked meanwhile must leave it alone.

    Use `Database.open`; a context manager.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection, lock: SweepLock) -> None:
        self.path = path
        self._connection = connection
        self._lock = lock
        self._file = os.stat(path)

    @classmethod
    def open(cls, path: str | Path, create: bool = True) -> Database:
        """Open the results file, or make it where `create` allows.

        Raises
        ------
        InputError
            The file is missing, damaged, another program's, of another schema version, in a place that cannot be
            written to, or in use by another sweep. It is left as it was.
        """
        path = Path(path)
        if not os.path.exists(path):
            if not create:
                raise InputError(f"{path}: no such file; `harness sweep` makes it")
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InputError(f"{path}: its folder cannot be made: {error.strerror}") from error
        elif not path.is_file():
            raise InputError(f"{path}: is no file; give a file with --db")
        lock = SweepLock(path)
        try:
            return cls(path, open_for_writing(path), lock)
        except BaseException:
            lock.release()
            raise

    def close(self) -> None:
        """Close the file and let other sweeps in."""
        self._connection.close()
        self._lock.release()

    def __enter__(self) -> Database:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def begin_sweep(
        self, command: str, commit: str | None, version: str, machine: Mapping[str, Any], packages: Mapping[str, str]
    ) -> int:
        """Note that a sweep begins, and return its number.

        Parameters
        ----------
        command : the command line that repeats it
        commit : of the repository, where there is one
        version : of harness
        machine : facts; the same `fingerprint` among them, or else the same facts, mean the same machine
        packages : {name: version}
        """
        with self._transaction() as connection:
            number = _machine(connection, machine)
            return _row_id(
                connection.execute(
                    "INSERT INTO sweep (started, command, commit_id, version, machine, packages) "
                    "VALUES (?, ?, ?, ?, ?, ?)",
                    (_now(), _text(command), commit, version, number, _json(packages)),
                )
            )

    def finish_sweep(self, sweep: int) -> None:
        """Note that a sweep has finished."""
        with self._transaction() as connection:
            connection.execute("UPDATE sweep SET finished = ? WHERE id = ?", (_now(), sweep))

    def list_experiment(
        self,
        sweep: int,
        name: str,
        title: str,
        question: str | None,
        source: str,
        specification: Mapping[str, Any],
        points: Sequence[PointRow],
    ) -> int:
        """Say what an experiment consists of now, in order, and return its number.

        Takes the place of its earlier listing; the runs of points that left stay. A point that several experiments
        share is stored once, one that is listed twice is listed at its first place.
        """
        with self._transaction() as connection:
            connection.execute(
                "INSERT INTO experiment (name, title, question, source, specification, sweep) "
                "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (name) DO UPDATE "
                "SET title = excluded.title, question = excluded.question, "
                "source = excluded.source, specification = excluded.specification, sweep = excluded.sweep",
                (name, title, question, source, _json(specification), sweep),
            )
            (experiment,) = connection.execute("SELECT id FROM experiment WHERE name = ?", (name,)).fetchone()
            connection.execute("DELETE FROM experiment_point WHERE experiment = ?", (experiment,))
            connection.executemany(
                "INSERT INTO point (key, parameters, plan) VALUES (?, ?, ?) "
                "ON CONFLICT (key) DO UPDATE SET parameters = excluded.parameters, "
                "plan = CASE excluded.plan WHEN '{}' THEN plan ELSE excluded.plan END",
                ((point.key, _json(point.parameters), _json(point.plan)) for point in points),
            )
            connection.executemany(
                "INSERT INTO experiment_point (experiment, point, place) SELECT ?, id, ? FROM point WHERE key = ? "
                "ON CONFLICT (experiment, point) DO NOTHING",
                ((experiment, place, point.key) for place, point in enumerate(points)),
            )
            show_leaves(connection)
            return int(experiment)

    @property
    def history(self) -> History:
        """What is measured already."""
        return History(self.path, self._connection)

    def done(self, keys: Iterable[str]) -> dict[str, dict[int, str]]:
        """For each of the keys {repeat: status} of its newest runs, {} where none is."""
        return self.history.done(keys)

    def add_run(
        self,
        sweep: int,
        key: str,
        repeat: int,
        status: Status,
        reason: str | None,
        stderr: str | None,
        metrics: Mapping[str, tuple[float, str]],
        timing_grade: bool,
        *,
        started: datetime | None = None,
        plan: Mapping[str, Any] | None = None,
        machine: Mapping[str, Any] | None = None,
        conditions: Mapping[str, float] | None = None,
    ) -> None:
        """Keep one run; it is on the disk when this returns.

        Parameters
        ----------
        key : of a point that was listed
        reason, stderr : why it is not ok, in a sentence, and the tail of what the run printed
        metrics : {name: (value, unit)}. An infinite value is kept as it is; one that is not a number as a row without a
            value, so that it can be told from a metric that was not reported.
        timing_grade : whether its clocks may be compared with others
        started : with its time zone
        plan : the pipeline that the run was made of, which the point has from now on
        machine : facts of where it ran, as in `begin_sweep`; without, the machine of the sweep
        conditions : load, frequency and the like while it ran, by name

        Raises
        ------
        KeyError
            The point was never listed.
        """
        begun = started.astimezone(timezone.utc).isoformat(timespec="milliseconds") if started else None
        with self._transaction() as connection:
            point = _point(connection, key)
            if plan is not None:
                connection.execute("UPDATE point SET plan = ? WHERE id = ?", (_json(plan), point))
            where = _machine_of(connection, sweep) if machine is None else _machine(connection, machine)
            run = _row_id(
                connection.execute(
                    "INSERT INTO run (point, repeat, sweep, status, reason, stderr, started, timing_grade, machine, "
                    "conditions) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                    (point, repeat, sweep, status, _text(reason), _text(stderr), begun, int(timing_grade), where,
                     _json(conditions or {})),
                )
            )  # fmt: skip
            connection.executemany(
                "INSERT INTO metric (run, name, value, unit) VALUES (?, ?, ?, ?)",  # SQLite makes NaN NULL
                ((run, name, float(value), unit) for name, (value, unit) in metrics.items()),
            )

    def add_control(
        self,
        sweep: int,
        key: str,
        repeat: int,
        status: Status,
        metrics: Mapping[str, float],
        machine: Mapping[str, Any] | None = None,
    ) -> None:
        """Keep the clocks of a control, a run done once more; the parameters are those of `add_run`."""
        with self._transaction() as connection:
            where = _machine_of(connection, sweep) if machine is None else _machine(connection, machine)
            connection.execute(
                "INSERT INTO control (point, repeat, sweep, machine, status, metrics) VALUES (?, ?, ?, ?, ?, ?)",
                (_point(connection, key), repeat, sweep, where, status, _json(dict(metrics))),
            )

    def add_verdicts(self, sweep: int, experiment: int, kind: VerdictKind, rows: Sequence[VerdictRow]) -> None:
        """Keep the verdicts on an experiment's expectations or claims, in order; a later call replaces an earlier."""
        with self._transaction() as connection:
            connection.execute(f"DELETE FROM {kind} WHERE experiment = ? AND sweep = ?", (experiment, sweep))
            connection.executemany(
                f"INSERT INTO {kind} (experiment, place, sweep, criterion, verdict, statement, detail) "
                "VALUES (?, ?, ?, ?, ?, ?, ?)",
                (
                    (experiment, place, sweep, _json(row.criterion), row.verdict, row.statement, _json(row.detail))
                    for place, row in enumerate(rows)
                ),
            )

    def add_comparison(
        self, command: str, experiment: str, backends: tuple[str, str], key: str, document: Mapping[str, Any]
    ) -> None:
        """Keep the comparison of two backends on the poses of an experiment, which need not have been swept."""
        with self._transaction() as connection:
            connection.execute(
                "INSERT INTO comparison (experiment, first, second, made, command, key, document) "
                "VALUES (?, ?, ?, ?, ?, ?, ?)",
                (experiment, *backends, _now(), _text(command), key, _json(document)),
            )

    def add_recording(self, key: str, recording: Recording) -> None:
        """Keep what a replay shows of a point, with its newest run that is ok; that run must have none yet.

        Raises
        ------
        KeyError
            No run of the point is ok.
        """
        with self._transaction() as connection:
            (run,) = connection.execute(
                "SELECT max(run.id) FROM run JOIN point ON point.id = run.point WHERE key = ? AND status = 'ok'", (key,)
            ).fetchone()
            if run is None:
                raise KeyError(key)
            write(connection, run, recording)

    def recorded(self, keys: Iterable[str]) -> set[str]:
        """The keys, of those given, whose points have a recording."""
        with as_input_error(self.path):
            return recorded(self._connection, keys)

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        connection = self._connection
        with as_input_error(self.path):
            self._require_file()
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
                connection.execute("COMMIT")
            except BaseException:
                if connection.in_transaction:  # a full disk has ended it already
                    connection.execute("ROLLBACK")
                raise

    def _require_file(self) -> None:
        """SQLite goes on writing to a file that has no name any more."""
        try:
            if os.path.samestat(os.stat(self.path), self._file):
                return
        except OSError:
            pass
        raise InputError(
            f"{self.path}: was removed or replaced while it was written to, with what it held; the same command "
            "measures anew"
        )


def _machine(connection: sqlite3.Connection, facts: Mapping[str, Any]) -> int:
    """The number of a machine; the same `fingerprint` among its facts, or else the same facts, mean the same one."""
    text = _json(facts)
    fingerprint = str(facts.get("fingerprint") or hashlib.sha256(text.encode()).hexdigest())
    connection.execute(
        "INSERT INTO machine (fingerprint, facts) VALUES (?, ?) ON CONFLICT (fingerprint) DO NOTHING",
        (fingerprint, text),
    )
    return int(connection.execute("SELECT id FROM machine WHERE fingerprint = ?", (fingerprint,)).fetchone()[0])


def _machine_of(connection: sqlite3.Connection, sweep: int) -> int:
    return int(connection.execute("SELECT machine FROM sweep WHERE id = ?", (sweep,)).fetchone()[0])


def _point(connection: sqlite3.Connection, key: str) -> int:
    found = connection.execute("SELECT id FROM point WHERE key = ?", (key,)).fetchone()
    if found is None:
        raise KeyError(key)
    return int(found[0])


def show_leaves(connection: sqlite3.Connection) -> None:
    """Make the view `runs` anew where it lacks a leaf: every run ever made, with a column a leaf.

    The names of leaves are words, so that they need no quoting.
    """
    leaves = [
        leaf
        for (leaf,) in connection.execute(
            "SELECT leaf.key FROM point, json_each(point.parameters) AS leaf "
            "GROUP BY leaf.key ORDER BY min(point.id), min(leaf.id)"
        )
    ]
    shown = {column for _, column, *_ in connection.execute("PRAGMA table_info(runs)")}
    if shown and shown.issuperset(leaves):
        return
    columns = ["run.id AS run", "point.key AS point", "repeat", "sweep", "status", "reason", "started", "timing_grade"]
    columns += [f"json_extract(parameters, '$.{leaf}') AS \"{leaf}\"" for leaf in leaves]
    connection.execute("DROP VIEW IF EXISTS runs")
    connection.execute(f"CREATE VIEW runs AS SELECT {', '.join(columns)} FROM run JOIN point ON point.id = run.point")


def _row_id(cursor: sqlite3.Cursor) -> int:
    return int(cursor.lastrowid or 0)  # None only where nothing was inserted


def _json(value: Any) -> str:
    """JSON text as the standard has it; a number that is none is an error of the caller."""
    return str(_text(json.dumps(value, ensure_ascii=False, allow_nan=False)))


def _text(text: str | None) -> str | None:
    """Text that can be stored, whatever bytes a run printed or a file is called by."""
    return None if text is None else text.encode("utf-8", "replace").decode()


def _now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="seconds")
