"""What is written is what is read, nothing measured is ever lost or changed, and a bad file is refused untouched."""

from __future__ import annotations

import math
import os
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Callable
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import pytest

from harness.errors import InputError
from harness.store import tables
from harness.store.connection import APPLICATION_ID, SCHEMA_VERSION
from harness.store.database import Database
from harness.store.records import PointRow, VerdictRow

GRID = PointRow("grid-5", {"count": 5, "algorithm": "grid"}, {"stages": [], "warnings": []})
TREE = PointRow("tree-5", {"count": 5, "algorithm": "tree"})


def begin(database: Database, **facts: Any) -> int:
    return database.begin_sweep("harness sweep", "abc123", "0.1.0", {"cores": 2, **facts}, {"numpy": "2.0"})


def listed(database: Database, sweep: int, *points: PointRow, name: str = "first", **specification: Any) -> int:
    return database.list_experiment(sweep, name, "A title", "Why?", "title: A title", specification, points)


def add(database: Database, sweep: int, key: str, repeat: int = 0, status: Any = "ok", **metrics: float) -> None:
    measured = {name: (value, "1") for name, value in metrics.items()}
    database.add_run(sweep, key, repeat, status, None, None, measured, timing_grade=True)


def test_a_sweep_reads_back_as_it_was_written(database: Database, path: Path) -> None:
    sweep = begin(database, fingerprint="here")
    experiment = listed(database, sweep, GRID, TREE, expect=[{"metric": "frames"}], claims=[])
    verdict = VerdictRow({"metric": "frames"}, "holds", "frames is 600", {"groups": [{"value": 600}]})
    database.add_verdicts(sweep, experiment, "expectation", [verdict])
    database.finish_sweep(sweep)

    (record,) = tables.experiments(path)
    assert (record.name, record.title, record.question, record.source) == ("first", "A title", "Why?", "title: A title")
    assert record.points == (GRID, TREE)
    assert record.expectations == (verdict,)
    assert record.claims == ()
    assert [record.sweep] == tables.sweeps(path)
    assert (record.sweep.commit, record.sweep.fingerprint, record.sweep.machine["cores"]) == ("abc123", "here", 2)
    assert record.sweep.packages == {"numpy": "2.0"}
    assert record.sweep.started.endswith("+00:00")
    assert record.sweep.finished is not None


def test_a_machine_is_known_by_its_fingerprint_or_else_by_its_facts(database: Database, path: Path) -> None:
    begin(database, fingerprint="a", load=1)
    begin(database, fingerprint="a", load=2)
    begin(database)
    begin(database)
    begin(database, memory=4)
    fingerprints = [sweep.fingerprint for sweep in tables.sweeps(path)]
    assert fingerprints[:2] == ["a", "a"]
    assert fingerprints[2] == fingerprints[3] != fingerprints[4]


def test_done_says_the_status_of_every_repeat(database: Database) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID, TREE)
    add(database, sweep, "grid-5", 0)
    add(database, sweep, "grid-5", 1, "timeout")
    assert database.done(["grid-5", "tree-5", "new"]) == {"grid-5": {0: "ok", 1: "timeout"}, "tree-5": {}, "new": {}}


def test_thousands_of_points_can_be_asked_for_at_once(database: Database) -> None:
    assert len(database.done(str(number) for number in range(40_000))) == 40_000


def test_measuring_again_adds_and_the_newest_run_is_current(database: Database, path: Path) -> None:
    first = begin(database)
    listed(database, first, GRID)
    add(database, first, "grid-5", 0, "failed", frames=1)
    second = begin(database)
    listed(database, second, GRID)
    add(database, second, "grid-5", 0, "ok", frames=600)

    assert database.done(["grid-5"]) == {"grid-5": {0: "ok"}}
    assert tables.runs(path)["frames"].tolist() == [600.0]
    with sqlite3.connect(path) as raw:
        assert raw.execute("SELECT count(*) FROM run").fetchone() == (2,)


def test_a_repeat_cannot_be_measured_twice_in_a_sweep(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID)
    add(database, sweep, "grid-5", 0, frames=1)
    with pytest.raises(sqlite3.IntegrityError):
        add(database, sweep, "grid-5", 0, frames=2)
    assert tables.runs(path)["frames"].tolist() == [1.0]


def test_a_run_is_kept_whole_or_not_at_all(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID)
    with pytest.raises(TypeError):
        database.add_run(sweep, "grid-5", 0, "ok", None, None, {"good": (1.0, "1"), "bad": ([], "1")}, True)  # type: ignore[dict-item]
    assert database.done(["grid-5"]) == {"grid-5": {}}
    add(database, sweep, "grid-5", 0, good=1)  # the failed transaction is over


def test_a_point_must_be_listed_before_it_is_measured(database: Database) -> None:
    with pytest.raises(KeyError, match="stranger"):
        add(database, begin(database), "stranger")


def test_what_is_not_a_number_is_kept_as_such_and_infinity_as_it_is(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID, TREE)
    add(database, sweep, "grid-5", drift=math.nan, ratio=math.inf)
    add(database, sweep, "tree-5", ratio=1)
    grid, tree = tables.run_records(path)
    assert math.isnan(grid.metrics["drift"])
    assert grid.metrics["ratio"] == math.inf
    assert "drift" not in tree.metrics


def test_whatever_a_run_printed_can_be_stored(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID)
    garbage = b"\xff\xfe\x00 caf\xc3\xa9".decode(errors="surrogateescape")
    database.add_run(sweep, "grid-5", 0, "crashed", f"signal 11: {garbage}", garbage, {}, timing_grade=False)
    (record,) = tables.run_records(path)
    assert record.reason is not None
    assert "café" in record.reason
    assert not record.timing_grade


def test_a_start_is_kept_in_utc(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID)
    start = datetime(2024, 5, 1, 1, 30, tzinfo=timezone(timedelta(hours=2)))
    database.add_run(sweep, "grid-5", 0, "ok", None, None, {}, True, started=start)
    with sqlite3.connect(path) as raw:
        assert raw.execute("SELECT started FROM run").fetchone() == ("2024-04-30T23:30:00.000+00:00",)


def test_a_listing_takes_the_place_of_the_one_before(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID, TREE)
    add(database, sweep, "grid-5")
    listed(database, sweep, TREE, GRID)
    assert [point.key for point in tables.experiments(path)[0].points] == ["tree-5", "grid-5"]
    listed(database, sweep, TREE)
    assert [point.key for point in tables.experiments(path)[0].points] == ["tree-5"]
    assert tables.runs(path).empty
    assert database.done(["grid-5"]) == {"grid-5": {0: "ok"}}  # no longer listed, still measured


def test_a_point_listed_twice_is_listed_once_at_its_first_place(database: Database, path: Path) -> None:
    listed(database, begin(database), GRID, TREE, GRID)
    assert [point.key for point in tables.experiments(path)[0].points] == ["grid-5", "tree-5"]


def test_a_point_gets_its_plan_from_its_run_and_keeps_it(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, TREE)
    plan = {"stages": [{"name": "rotation", "kept": False, "why": "no spin"}], "warnings": []}
    database.add_run(sweep, "tree-5", 0, "ok", None, None, {}, True, plan=plan)
    listed(database, sweep, TREE)
    assert tables.experiments(path)[0].points[0].plan == plan


def test_the_view_has_a_column_for_every_leaf_also_for_new_ones(database: Database, path: Path) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID)
    add(database, sweep, "grid-5")
    odd = PointRow("odd", {"count": 7, "size": {"uniform": [0.5, 1.5]}, "order": 1})
    listed(database, sweep, odd, name="second")
    add(database, sweep, "odd")
    with sqlite3.connect(path) as raw:
        rows = raw.execute('SELECT point, count, algorithm, size, "order" FROM runs ORDER BY run').fetchall()
    assert rows == [("grid-5", 5, "grid", None, None), ("odd", 7, None, '{"uniform":[0.5,1.5]}', 1)]


def test_numbers_that_are_none_are_refused_in_what_describes_a_measurement(database: Database) -> None:
    with pytest.raises(ValueError, match="JSON"):
        listed(database, begin(database), PointRow("x", {"count": math.nan}))


def test_verdicts_of_a_sweep_can_be_given_again(database: Database, path: Path) -> None:
    sweep = begin(database)
    experiment = listed(database, sweep, GRID)
    database.add_verdicts(sweep, experiment, "claim", [VerdictRow({}, "undecided", "a"), VerdictRow({}, "holds", "b")])
    database.add_verdicts(sweep, experiment, "claim", [VerdictRow({}, "holds", "c")])
    assert [row.statement for row in tables.experiments(path)[0].claims] == ["c"]


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


def test_runs_that_lack_a_metric_are_found_by_their_newest_run(database: Database) -> None:
    sweep = begin(database)
    listed(database, sweep, GRID, TREE)
    add(database, sweep, "grid-5", 0, reversal_error=0.0, frames=600)
    add(database, sweep, "grid-5", 1, frames=600)
    add(database, sweep, "tree-5", 0, "failed")
    history = database.history
    asked = {"grid-5": {"reversal_error"}, "tree-5": {"reversal_error"}, "unknown": {"frames"}}
    assert history.lacking_metrics(asked) == [("grid-5", 1)]
    assert history.lacking_metrics({"grid-5": set()}) == []
    again = begin(database)
    add(database, again, "grid-5", 1, reversal_error=0.0)
    assert database.history.lacking_metrics(asked) == []
