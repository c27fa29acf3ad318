"""What is measured already: for a sweep that resumes, and for one that only says what it would do."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from harness.store.connection import as_input_error, open_for_reading


class History:
    """The runs of earlier sweeps.

    Parameters
    ----------
    path : the results file, named in errors
    connection : open on it
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self._path = path
        self._connection = connection

    def done(self, keys: Iterable[str], sweeps: Iterable[int] | None = None) -> dict[str, dict[int, str]]:
        """What is measured: for each of the keys {repeat: status} of its newest runs, {} where none is.

        Parameters
        ----------
        sweeps : count only what these have measured
        """
        found: dict[str, dict[int, str]] = {key: {} for key in keys}
        with as_input_error(self._path):
            for key, repeat, status in self._connection.execute(
                "SELECT point.key, repeat, status FROM run JOIN point ON point.id = run.point "
                "WHERE point.key IN (SELECT value FROM json_each(?1)) "
                "AND (?2 IS NULL OR sweep IN (SELECT value FROM json_each(?2))) ORDER BY run.id",
                (json.dumps(list(found)), _list(sweeps)),
            ):
                found[key][repeat] = status
        return found

    def controlled(self, keys: Iterable[str], sweeps: Iterable[int] | None = None) -> set[tuple[str, int]]:
        """The keys and repeats that have a control; of these sweeps, where they are given."""
        with as_input_error(self._path):
            rows = self._connection.execute(
                "SELECT key, repeat FROM control JOIN point ON point.id = control.point "
                "WHERE key IN (SELECT value FROM json_each(?1)) "
                "AND (?2 IS NULL OR sweep IN (SELECT value FROM json_each(?2)))",
                (json.dumps(list(keys)), _list(sweeps)),
            )
            return set(rows)

    def lacking_metrics(self, metrics: Mapping[str, Collection[str]]) -> list[tuple[str, int]]:
        """The keys and repeats whose newest run ended well but lacks one of the metrics that are asked of its key."""
        wanted = {key: set(names) for key, names in metrics.items() if names}
        found: dict[tuple[str, int], set[str]] = {}
        with as_input_error(self._path):
            for key, repeat, name in self._connection.execute(
                "SELECT key, repeat, name FROM current_run JOIN point ON point.id = current_run.point "
                "LEFT JOIN metric ON metric.run = current_run.id "
                "WHERE status = 'ok' AND key IN (SELECT value FROM json_each(?))",
                (json.dumps(list(wanted)),),
            ):
                found.setdefault((key, repeat), set()).add(name)
        return [(key, repeat) for (key, repeat), names in found.items() if wanted[key] - names]

    def values(self, metric: str, keys: Iterable[str]) -> dict[str, set[float]]:
        """What the newest runs of these keys that ended well report of a metric; nothing of a key without any."""
        found: dict[str, set[float]] = {}
        with as_input_error(self._path):
            for key, value in self._connection.execute(
                "SELECT key, value FROM current_run JOIN point ON point.id = current_run.point "
                "JOIN metric ON metric.run = current_run.id "
                "WHERE status = 'ok' AND name = ? AND value IS NOT NULL AND key IN (SELECT value FROM json_each(?))",
                (metric, json.dumps(list(keys))),
            ):
                found.setdefault(key, set()).add(value)
        return found

    def unfinished_sweeps(self, command: str) -> list[int]:
        """The newest sweeps, back to the first that finished or had another command line than this."""
        with as_input_error(self._path):
            rows = self._connection.execute(
                "SELECT id FROM sweep WHERE id > "
                "(SELECT coalesce(max(id), 0) FROM sweep WHERE finished IS NOT NULL OR command <> ?)",
                (command,),
            )
            return [number for (number,) in rows]

    def compared(self) -> set[str]:
        """The keys of all comparisons of backends."""
        with as_input_error(self._path):
            return {key for (key,) in self._connection.execute("SELECT DISTINCT key FROM comparison")}

    def durations(self) -> dict[str, float]:
        """Mean elapsed seconds of a run, by the key of its point, and by its parameters as sorted JSON text.

        The parameters find what an earlier version of the program has measured under another key.
        """
        found: dict[str, float] = {}
        with as_input_error(self._path):
            for key, parameters, seconds in self._connection.execute(
                "SELECT key, parameters, avg(json_extract(conditions, '$.seconds')) FROM run "
                "JOIN point ON point.id = run.point GROUP BY point.id "
                "HAVING avg(json_extract(conditions, '$.seconds')) IS NOT NULL ORDER BY max(run.id)"
            ):
                found[key] = seconds
                found[json.dumps(json.loads(parameters), sort_keys=True)] = seconds
        return found


@contextmanager
def history_of(path: str | Path) -> Iterator[History]:
    """The history of a results file, for reading alone.

    Raises
    ------
    InputError
        The file is missing, empty, damaged, another program's, or of another schema version.
    """
    with reading(path) as connection:
        yield History(Path(path), connection)


# The file of which all is read at one moment, and the connection that does.
_HELD: ContextVar[tuple[Path, sqlite3.Connection] | None] = ContextVar("held", default=None)


@contextmanager
def at_one_moment(path: str | Path) -> Iterator[None]:
    """All that is read of a results file inside is of one moment, and by one connection; errors as of `history_of`."""
    with reading(path) as connection:
        token = _HELD.set((Path(path), connection))
        try:
            yield
        finally:
            _HELD.reset(token)


@contextmanager
def reading(path: str | Path) -> Iterator[sqlite3.Connection]:
    """A connection that sees the results as they are at one moment; errors as of `history_of`."""
    path = Path(path)
    held_path, held_connection = _HELD.get() or (None, None)
    if held_path == path and held_connection is not None:
        with as_input_error(path):
            yield held_connection
        return
    connection = open_for_reading(path)
    try:
        with as_input_error(path):
            connection.execute("BEGIN")  # so that all that is read is of one moment
            yield connection
    finally:
        connection.close()


def _list(sweeps: Iterable[int] | None) -> str | None:
    return None if sweeps is None else json.dumps(list(sweeps))
