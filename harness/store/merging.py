"""Bringing results of several files together: every sweep and run of all, in the order of their time, none twice."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.errors import InputError
from harness.store.connection import as_input_error, create_tables, open_for_reading, open_for_writing
from harness.store.database import show_leaves
from harness.store.lock import SweepLock

# Numbers of two machines are never mixed: of a point that several have measured, all repeats shown are of the machine
# that measured it last. The number of a run grows with time; its machine is that of its sweep.
_CURRENT_RUN = """
DROP VIEW current_run;
CREATE VIEW current_run AS
    WITH swept AS (SELECT run.id AS id, run.point AS point, run.repeat AS repeat, sweep.machine AS machine
                   FROM run JOIN sweep ON sweep.id = run.sweep),
         newest AS (SELECT point, machine FROM swept WHERE id IN (SELECT max(id) FROM swept GROUP BY point))
    SELECT * FROM run WHERE id IN (
        SELECT max(swept.id) FROM swept JOIN newest ON newest.point = swept.point AND newest.machine = swept.machine
        GROUP BY swept.point, swept.repeat);
"""

# The run that a sweep began with: times of sweeps are whole seconds, and two may begin in the same one.
_FIRST_RUNS = """
SELECT sweep, key || ' ' || repeat || ' ' || coalesce(run.started, '') FROM run JOIN point ON point.id = run.point
WHERE run.id IN (SELECT min(id) FROM run GROUP BY sweep)
"""

Row = dict[str, Any]
Name = tuple[Any, ...]


@dataclass(frozen=True)
class Merged:
    """How much the file held before, and how much it holds now."""

    sweeps: tuple[int, int]
    runs: tuple[int, int]
    machines: tuple[int, int]


def merge(into: Path, others: Sequence[Path]) -> Merged:
    """Add all that other results files hold to one; what it has already is not added again.

    Sweeps and runs are numbered anew in the order in which sweeps began. An experiment is listed as its newest sweep
    listed it.

    Parameters
    ----------
    into : the file that is added to
    others : they are only read

    Raises
    ------
    InputError
        A file is missing, damaged, another program's, of another schema version, or in use by a sweep. Nothing was
        changed.
    """
    for other in others:
        if other.resolve() == into.resolve():
            raise InputError(f"{other}: is the file that is added to; give others after it")
    sources = [open_for_reading(path) for path in (into, *others)]
    try:
        lock = SweepLock(into)
        try:
            return _replace(into, sources)
        finally:
            lock.release()
    finally:
        for source in sources:
            source.close()


def _replace(into: Path, sources: Sequence[sqlite3.Connection]) -> Merged:
    before = _counts(sources[0])
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as made:
        create_tables(made)
        made.execute("BEGIN")
        union = _Union(made)
        for source in sources:
            with as_input_error(into):
                source.execute("BEGIN")  # so that all that is read is of one moment
            union.read(source)
        union.write()
        made.execute("COMMIT")
        made.executescript(_CURRENT_RUN)
        after = _counts(made)
        sources[0].execute("COMMIT")
        with closing(open_for_writing(into)) as target, as_input_error(into):
            made.backup(target)  # one transaction
    return Merged(*zip(before, after, strict=True))


def _counts(connection: sqlite3.Connection) -> list[int]:
    tables = ("sweep", "run", "machine")
    return [int(connection.execute(f"SELECT count(*) FROM {table}").fetchone()[0]) for table in tables]


class _Union:
    """The rows of several files, each known by what it is and not by its number.

    A machine is known by its fingerprint, a sweep by its begin, command, machine and first run, a point by its key, an
    experiment by its name, a run by its point, repeat and sweep.
    """

    def __init__(self, made: sqlite3.Connection) -> None:
        self._made = made
        self._machines: dict[str, Row] = {}
        self._sweeps: dict[Name, Row] = {}
        self._points: dict[str, Row] = {}
        self._experiments: dict[str, tuple[Row, list[str]]] = {}
        self._runs: dict[Name, Row] = {}
        self._of_runs: dict[str, dict[Name, list[Row]]] = {
            name: {} for name in ("metric", "event", "frame", "recording")
        }
        self._meshes: dict[str, Row] = {}
        self._controls: dict[Name, Row] = {}
        self._verdicts: dict[str, dict[Name, Row]] = {"expectation": {}, "claim": {}}
        self._comparisons: dict[Name, Row] = {}

    def read(self, source: sqlite3.Connection) -> None:
        """Add the rows of a file, those that are not known yet."""
        machines = {row["id"]: row["fingerprint"] for row in self._keep(source, "machine", self._machines)}
        sweeps: dict[int, Name] = {}
        first = dict(source.execute(_FIRST_RUNS).fetchall())
        for row in _rows(source, "sweep"):
            row["machine"] = machines[row["machine"]]
            begin = (row["started"], row["command"], row["machine"], first.get(row["id"], ""))
            same = sum(name[:-1] == begin for name in sweeps.values())  # earlier ones of this file, told by their order
            sweeps[row["id"]] = (*begin, f"{same:06}")
            known = self._sweeps.setdefault(sweeps[row["id"]], row)
            known["finished"] = known["finished"] or row["finished"]
        points = {row["id"]: row["key"] for row in self._keep(source, "point", self._points)}
        for row in _rows(source, "point"):
            if self._points[row["key"]]["plan"] == "{}":
                self._points[row["key"]]["plan"] = row["plan"]
        experiments = self._read_experiments(source, sweeps, points)
        runs: dict[int, Name] = {}
        of: dict[str, Mapping[int, Any]] = {
            "point": points,
            "sweep": sweeps,
            "machine": machines,
            "experiment": experiments,
        }
        for row in _rows(source, "run"):
            row = _with(row, of)
            runs[row["id"]] = (row["point"], row["repeat"], row["sweep"])
            self._runs.setdefault(runs[row["id"]], row)
        self._keep(source, "mesh", self._meshes)
        for table, kept in self._of_runs.items():
            found: dict[Name, list[Row]] = {}
            for row in _rows(source, table):
                found.setdefault(runs[row["run"]], []).append(row)
            for run, rows in found.items():
                kept.setdefault(run, rows)
        for row in _rows(source, "control"):
            row = _with(row, of)
            self._controls.setdefault((row["point"], row["repeat"], row["sweep"]), row)
        for table, judged in self._verdicts.items():
            for row in _rows(source, table):
                row = _with(row, of)
                judged.setdefault((row["experiment"], row["sweep"], row["place"]), row)
        for row in _rows(source, "comparison"):
            self._comparisons.setdefault(
                tuple(row[name] for name in ("made", "experiment", "first", "second", "key")), row
            )

    def _keep(self, source: sqlite3.Connection, table: str, known: dict[str, Row]) -> Iterator[Row]:
        """All rows of a table; those whose name, its one text that is unique, is not known yet are added."""
        name = {"machine": "fingerprint", "point": "key", "mesh": "digest"}[table]
        rows = list(_rows(source, table))
        for row in rows:
            known.setdefault(row[name], row)
        return iter(rows)

    def _read_experiments(
        self, source: sqlite3.Connection, sweeps: Mapping[int, Name], points: Mapping[int, str]
    ) -> dict[int, str]:
        listed: dict[int, list[str]] = {}
        for experiment, point in source.execute("SELECT experiment, point FROM experiment_point ORDER BY place"):
            listed.setdefault(experiment, []).append(points[point])
        names = {}
        for row in _rows(source, "experiment"):
            row["sweep"] = sweeps[row["sweep"]]
            names[row["id"]] = row["name"]
            known = self._experiments.get(row["name"])
            if known is None or known[0]["sweep"] < row["sweep"]:
                self._experiments[row["name"]] = row, listed.get(row["id"], [])
        return names

    def write(self) -> None:
        """Write all of it, numbered in the order of time."""
        machines = self._number("machine", self._machines)
        for row in self._sweeps.values():
            row["machine"] = machines[row["machine"]]
        sweeps = self._number("sweep", dict(sorted(self._sweeps.items())))
        points = self._number("point", self._points)
        for row, _ in self._experiments.values():
            row["sweep"] = sweeps[row["sweep"]]
        experiments = self._number("experiment", {name: row for name, (row, _) in self._experiments.items()})
        for name, (_, keys) in self._experiments.items():
            self._made.executemany(
                "INSERT INTO experiment_point (experiment, point, place) VALUES (?, ?, ?)",
                ((experiments[name], points[key], place) for place, key in enumerate(keys)),
            )
        of = {"machine": machines, "sweep": sweeps, "point": points, "experiment": experiments}
        in_time = dict(sorted(self._runs.items(), key=lambda item: sweeps[item[1]["sweep"]]))
        runs = self._number("run", {name: _with(row, of) for name, row in in_time.items()})
        for row in self._meshes.values():
            self._insert("mesh", row)
        for table, known in self._of_runs.items():
            for run, rows in known.items():
                for row in rows:
                    self._insert(table, row | {"run": runs[run]})
        for row in self._controls.values():
            self._insert("control", _with(row, of))
        for table, judged in self._verdicts.items():
            for row in judged.values():
                self._insert(table, _with(row, of))
        self._number("comparison", dict(sorted(self._comparisons.items())))
        show_leaves(self._made)

    def _number(self, table: str, rows: Mapping[Any, Row]) -> dict[Any, int]:
        """Insert rows in this order, numbered from 1, and return the number of each."""
        numbers = {name: place for place, name in enumerate(rows, start=1)}
        for name, row in rows.items():
            self._insert(table, row | {"id": numbers[name]})
        return numbers

    def _insert(self, table: str, row: Row) -> None:
        marks = ", ".join("?" * len(row))
        self._made.execute(f"INSERT INTO {table} ({', '.join(row)}) VALUES ({marks})", list(row.values()))


def _with(row: Row, of: Mapping[str, Mapping[Any, Any]]) -> Row:
    """A row with names in the place of numbers, or with other numbers in the place of names."""
    return {name: of[name][value] if name in of else value for name, value in row.items()}


def _rows(source: sqlite3.Connection, table: str) -> Iterator[Row]:
    """The rows of a table in the order in which they were added."""
    cursor = source.execute(f"SELECT * FROM {table}")
    names = [column for column, *_ in cursor.description]
    rows = (dict(zip(names, row, strict=True)) for row in cursor)
    return iter(sorted(rows, key=lambda row: row["id"])) if "id" in names else rows
