"""A results file that cannot be read or written is refused in a sentence, and left as it is."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.store import tables
from harness.store.connection import APPLICATION_ID, SCHEMA_VERSION
from harness.store.database import Database
from harness.store.records import PointRow
from tests.store.writing import GRID, add, begin, listed

# Files that must be refused, and left as they are


def corrupt(path: Path) -> None:
    with Database.open(path) as database:
        sweep = begin(database)
        listed(database, sweep, *(PointRow(f"p{number}", {"count": number}) for number in range(300)))
    data = bytearray(path.read_bytes())
    data[4096 : len(data) : 4096] = b"\xa5" * len(data[4096 : len(data) : 4096])  # every page but the first
    path.write_bytes(data)


def truncated(path: Path) -> None:
    corrupt(path)
    path.write_bytes(path.read_bytes()[:5000])


def no_letters(path: Path) -> None:
    """With bytes that are no UTF-8 in the SQL of a table, which SQLite repeats in what it says."""
    Database.open(path).close()
    path.write_bytes(path.read_bytes().replace(b"CREATE TABLE metric", b"CREATE \xf3ABLE metric"))


def text(path: Path) -> None:
    path.write_text("dear diary, " * 500)


def foreign(path: Path) -> None:
    with sqlite3.connect(path) as raw:
        raw.execute("CREATE TABLE diary (day TEXT)")


def of_version(version: int) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        Database.open(path).close()
        raw = sqlite3.connect(path)
        raw.execute(f"PRAGMA user_version = {version}")
        raw.close()

    return make


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (no_letters, "is damaged"),
        (corrupt, "is damaged"),
        (truncated, "is damaged"),
        (text, "is not a results database"),
        (foreign, "is a database of another program"),
        (of_version(SCHEMA_VERSION + 1), "was written by a newer harness"),
        (of_version(SCHEMA_VERSION - 1), "was written by an older harness"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_and_left_as_it_is(
    path: Path, spoil: Callable[[Path], None], message: str
) -> None:
    spoil(path)
    before = path.read_bytes()
    for use in (Database.open, tables.runs, tables.experiments, tables.sweeps):
        with pytest.raises(InputError, match=message) as caught:
            use(path)
        assert str(caught.value).startswith(f"{path}: ")
        assert "nothing was changed" in str(caught.value)
    assert path.read_bytes() == before
    assert not (path.parent / "results.db-sweep").exists()


def test_an_empty_file_is_a_database_to_be(path: Path) -> None:
    path.touch()
    with pytest.raises(InputError, match="holds no results yet"):
        tables.runs(path)
    Database.open(path).close()
    assert tables.runs(path).empty


def test_the_file_says_what_it_is(database: Database, path: Path) -> None:
    with sqlite3.connect(path) as raw:
        assert raw.execute("PRAGMA application_id").fetchone() == (APPLICATION_ID,)
        assert raw.execute("PRAGMA user_version").fetchone() == (SCHEMA_VERSION,)
        assert raw.execute("PRAGMA journal_mode").fetchone() == ("wal",)
        assert raw.execute("PRAGMA foreign_key_check").fetchall() == []


def test_a_missing_file_is_made_for_a_sweep_and_missed_by_a_reader(tmp_path: Path) -> None:
    path = tmp_path / "new" / "deep" / "100% #1?.db"
    with pytest.raises(InputError, match="no such file"):
        tables.runs(path)
    with pytest.raises(InputError, match="no such file"):
        Database.open(path, create=False)
    assert not path.parent.exists()
    Database.open(path).close()
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_a_folder_is_no_database(tmp_path: Path) -> None:
    for use in (Database.open, tables.runs):
        with pytest.raises(InputError, match="is no file"):
            use(tmp_path)


def test_a_folder_that_cannot_be_made_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="its folder cannot be made"):
        Database.open(tmp_path / "file" / "results.db")


def test_a_full_disk_keeps_what_was_measured(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID)
    add(database, sweep, "grid-5", 0, frames=600)
    (pages,) = database._connection.execute("PRAGMA page_count").fetchone()
    database._connection.execute(f"PRAGMA max_page_count = {pages}")
    with pytest.raises(InputError, match="the disk is full"):
        database.add_run(sweep, "grid-5", 1, "failed", None, "x" * 100_000, {}, True)
    database._connection.execute("PRAGMA max_page_count = 1000000")
    add(database, sweep, "grid-5", 1, frames=600)
    assert tables.runs(path)["repeat"].tolist() == [0, 1]


def test_another_program_that_holds_the_file_is_waited_for_and_then_named(
    database: Database, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep = begin(database)
    database._connection.execute("PRAGMA busy_timeout = 50")
    other = sqlite3.connect(path, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    with pytest.raises(InputError, match="is locked: another program"):
        listed(database, sweep, GRID)
    other.execute("COMMIT")
    listed(database, sweep, GRID)
    other.close()


def test_a_second_sweep_is_refused_while_the_first_goes_on(path: Path) -> None:
    attempt = (
        "import sys\nfrom harness.errors import InputError\nfrom harness.store.database import Database\n"
        "try:\n    Database.open(sys.argv[1]).close()\nexcept InputError as error:\n    sys.exit(str(error))"
    )

    def second() -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-c", attempt, str(path)], capture_output=True, text=True, check=False)

    with Database.open(path) as first:
        refused = second()
        assert refused.returncode == 1
        assert f"another sweep is writing to it (process {os.getpid()} on" in refused.stderr
        begin(first)
    assert second().returncode == 0
    assert len(tables.sweeps(path)) == 1


def as_nobody(action: Callable[[], None]) -> str:
    """What an action that must fail says to a user without rights; root may write everywhere."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        message = "nothing was refused"
        try:
            if os.geteuid() == 0:
                os.setgid(65534)
                os.setuid(65534)
            action()
        except BaseException as error:
            message = f"{type(error).__name__}: {error}"
        os.write(writing, message.encode())
        os._exit(0)
    os.close(writing)
    os.waitpid(child, 0)
    with os.fdopen(reading) as printed:
        return printed.read()


@pytest.fixture
def read_only(path: Path) -> Path:
    """A database with one listing, in a folder that may not be written to."""
    with Database.open(path) as database:
        listed(database, begin(database), GRID)
    for folder in path.parents:
        if folder == Path(tempfile.gettempdir()):
            break
        folder.chmod(0o755)
    path.chmod(0o444)
    path.parent.chmod(0o555)
    return path


def test_a_read_only_folder_is_refused(read_only: Path) -> None:
    printed = as_nobody(lambda: Database.open(read_only).close())
    assert printed.startswith("InputError")
    assert "cannot be written to" in printed


def test_a_read_only_file_in_a_writable_folder_is_refused(read_only: Path) -> None:
    read_only.parent.chmod(0o777)
    printed = as_nobody(lambda: Database.open(read_only).close())
    assert "InputError" in printed
    assert "cannot be written to" in printed


def test_results_in_a_read_only_folder_can_be_read(read_only: Path) -> None:
    def read() -> None:
        raise AssertionError([record.name for record in tables.experiments(read_only)])

    assert as_nobody(read) == "AssertionError: ['first']"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("UPDATE point SET parameters = '{'", "point.parameters is no JSON object"),
        ("UPDATE point SET parameters = '[1]'", "point.parameters is no JSON object"),
        ("UPDATE run SET conditions = '[1]'", "run.conditions is no JSON object"),
        ("""UPDATE run SET conditions = '{"load": "high"}'""", "run.conditions has a value of another kind"),
        ("""UPDATE point SET plan = '{"stages": 3}'""", "point.plan has no stages as it must be"),
        ("""UPDATE point SET plan = '{"stages": [3]}'""", "point.plan has a value of another kind in stages"),
        ("""UPDATE point SET plan = '{"stages": [{}]}'""", "point.plan has no kept in stages"),
        ("""UPDATE experiment SET specification = '{"expect": 3}'""", "experiment.specification has no expect"),
        ("UPDATE metric SET value = 'abc'", "metric.value is no number"),
        ("UPDATE run SET repeat = 'abc'", "run.repeat is no number"),
        ("UPDATE run SET sweep = 77", "a row of run refers to a row of sweep that is not there"),
        ("DROP TABLE claim", "claim lacks criterion"),
        ("DROP VIEW current_run", "current_run lacks conditions"),
        ("ALTER TABLE run RENAME COLUMN reason TO why", "run lacks reason"),
        (
            "INSERT INTO comparison VALUES (1, 'e', 'fcl', 'pybullet', '', '', 'k', '{}')",
            "comparison.document tells neither of pairs of backends nor of cases",
        ),
    ],
)
def test_rows_that_the_program_does_not_write_are_damage_too(path: Path, change: str, message: str) -> None:
    with Database.open(path) as database:
        sweep = begin(database)
        listed(database, sweep, GRID)
        add(database, sweep, GRID.key, frames=30.0)
    raw = sqlite3.connect(path)
    raw.executescript(f"PRAGMA ignore_check_constraints = ON; {change}")
    raw.close()
    for use in (Database.open, tables.runs):
        with pytest.raises(InputError, match=f"is damaged: {message}.*; nothing was changed"):
            use(path)
