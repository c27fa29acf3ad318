"""Connections to a results file: opened only if it is valid and ours; every failure becomes a sentence for a person.

Files of another program, another schema version, or damaged ones are refused before anything is written: the check runs
on a connection that cannot write.
"""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path

from harness.errors import InputError
from harness.store.soundness import damage

APPLICATION_ID = 0x68726E73  # "hrns", in the file's header
SCHEMA_VERSION = 3
BUSY_SECONDS = 10.0

# Parts of SQLite's messages (Python 3.10 has no error codes), and the sentence for a person.
_SENTENCES = {
    "file is not a database": "is not a results database; nothing was changed. Give another file with --db",
    "malformed": "is damaged; nothing was changed. Keep a copy (`sqlite3 FILE .recover` can often save its rows) and "
    "sweep into another file with --db",
    "disk is full": "cannot grow: the disk is full. Every finished run is kept; make room, and the same command "
    "does the rest",
    "disk I/O error": "cannot be written to: its disk is full or gone, or the file may not grow (`ulimit -f`). Every "
    "finished run is kept; mend that, and the same command does the rest",
    "readonly": "cannot be written to: it, its folder or its disk is read-only. Give another file with --db",
    "locked": f"is locked: another program has kept it from being used for {BUSY_SECONDS:g} s. Close that program, and "
    "the same command goes on from here",
    "unable to open": "cannot be opened: its folder is missing or not accessible, or it is no file",
}


def open_for_reading(path: Path) -> sqlite3.Connection:
    """A connection that cannot write, also while a sweep is writing.

    Raises
    ------
    InputError
        The file is missing, empty, damaged, another program's, or of another schema version.
    """
    if not os.path.exists(path):  # unlike Path.exists, False where it may not be asked
        raise InputError(f"{path}: no such file; `harness sweep` makes it")
    if not path.is_file():
        raise InputError(f"{path}: is no file; give a file with --db")
    with as_input_error(path):
        connection = _connect_read_only(path)
        try:
            if not _is_results(connection, path):
                raise InputError(f"{path}: holds no results yet; `harness sweep` fills it")
        except BaseException:
            connection.close()
            raise
        return connection


def open_for_writing(path: Path) -> sqlite3.Connection:
    """A connection for the one process that writes; makes the file where there is none.

    Transactions are explicit, and each is on the disk when it ends: a killed process or a power cut loses at most the
    one that had not ended.

    Raises
    ------
    InputError
        The file is damaged, another program's, of another schema version, or cannot be written to.
    """
    if os.path.exists(path):
        with as_input_error(path):
            reading = _connect_read_only(path)
            try:
                _is_results(reading, path)
            finally:
                reading.close()
    with as_input_error(path):
        connection = _connect(path, "rwc")
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
            connection.execute("PRAGMA foreign_keys = ON")
            if _is_empty(connection):
                create_tables(connection)
            # SQLite opens a file that it may not write to without an error: this finds out now, not after the first run
            connection.execute("BEGIN IMMEDIATE")
            connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
            connection.execute("ROLLBACK")
        except BaseException:
            connection.close()
            raise
        return connection


@contextmanager
def as_input_error(path: Path) -> Iterator[None]:
    """Turn what SQLite raises about a file into an InputError; errors of the program pass through."""
    try:
        yield
    except (sqlite3.IntegrityError, sqlite3.ProgrammingError, sqlite3.InterfaceError):
        raise
    except sqlite3.Error as error:
        raise InputError(f"{path}: {_sentence(str(error))}") from error
    except UnicodeDecodeError as error:  # what SQLite says of a damaged schema has the damage in it
        raise InputError(f"{path}: {_sentence('malformed')}") from error


def _sentence(message: str) -> str:
    for part, sentence in _SENTENCES.items():
        if part in message:
            return sentence
    return f"cannot be used: {message}"


def _connect(path: Path, mode: str) -> sqlite3.Connection:
    uri = f"{path.absolute().as_uri()}?mode={mode}"
    return sqlite3.connect(uri, uri=True, timeout=BUSY_SECONDS, isolation_level=None)


def _connect_read_only(path: Path) -> sqlite3.Connection:
    connection = _connect(path, "ro")
    try:
        connection.execute("SELECT count(*) FROM sqlite_master")
    except sqlite3.OperationalError as error:
        # A write-ahead log needs files beside the database; in a read-only place, and where no log was left behind, it
        # can be read without them
        connection.close()
        log = path.with_name(f"{path.name}-wal")
        if not any(part in str(error) for part in ("unable to open", "readonly")):
            raise
        if log.exists() and log.stat().st_size > 0:
            raise InputError(
                f"{path}: cannot be read where it cannot be written to, for its sweep was killed. Copy it "
                f"with {log.name} into a folder that can be written to, and read it there"
            ) from error
        connection = _connect(path, "ro&immutable=1")
    except BaseException:
        connection.close()
        raise
    return connection


def _is_empty(connection: sqlite3.Connection) -> bool:
    (tables,) = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    return bool(tables == 0 and application == 0)


def _is_results(connection: sqlite3.Connection, path: Path) -> bool:
    """Whether the file holds results; False for an empty one, as a sweep killed at its start leaves it."""
    if _is_empty(connection):
        return False
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if application != APPLICATION_ID:
        raise InputError(f"{path}: is a database of another program; nothing was changed. Give another file with --db")
    if version > SCHEMA_VERSION:
        raise InputError(
            f"{path}: was written by a newer harness (schema {version}, this one knows {SCHEMA_VERSION}); nothing was "
            "changed. Update harness, or give another file with --db"
        )
    if version < SCHEMA_VERSION:
        raise InputError(
            f"{path}: was written by an older harness (schema {version}, this one needs {SCHEMA_VERSION}); nothing was "
            "changed. Export it with the harness that wrote it, and sweep into another file with --db"
        )
    (state,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    if state != "ok":
        raise sqlite3.DatabaseError(f"malformed: {state}")
    if (wrong := damage(connection, _tables())) is not None:
        raise InputError(
            f"{path}: is damaged: {wrong}; nothing was changed. Keep a copy, and sweep into another file with --db"
        )
    return True


def _tables() -> str:
    return files("harness.store").joinpath("schema.sql").read_text(encoding="utf-8")


def create_tables(connection: sqlite3.Connection) -> None:
    """Make an empty results database."""
    # One transaction, header fields included, so that a file is either empty or whole
    connection.executescript(
        f"BEGIN IMMEDIATE;\n{_tables()}\n"
        f"PRAGMA application_id = {APPLICATION_ID};\nPRAGMA user_version = {SCHEMA_VERSION};\nCOMMIT;"
    )
