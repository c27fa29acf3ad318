"""What is written is what is read, nothing measured is ever lost or changed, and a bad file is refused untouched."""

from __future__ import annotations

import math
import sqlite3
from datetime import datetime, timedelta, timezone
from pathlib import Path

import pytest

from harness.store import tables
from harness.store.database import Database
from harness.store.records import PointRow, VerdictRow
from tests.store.writing import GRID, TREE, add, begin, listed


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
