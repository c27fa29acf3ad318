"""The run table has a row for every experiment, listed point and repeat, in a shape that can be computed with."""

from __future__ import annotations

import math
from pathlib import Path

from harness.store import tables
from harness.store.database import Database
from harness.store.records import PointRow, RunRecord, VerdictRow


def record(**changes: object) -> RunRecord:
    fields = {
        "experiment": "e",
        "point": "p",
        "repeat": 0,
        "status": "ok",
        "reason": None,
        "sweep": 1,
        "timing_grade": True,
        "parameters": {"count": 5},
        "metrics": {"frames": 600},
    }
    return RunRecord(**(fields | changes))  # type: ignore[arg-type]


def fill(database: Database) -> None:
    sweep = database.begin_sweep("harness sweep", None, "0.1.0", {}, {})
    points = [PointRow(f"p{count}", {"count": count, "mesh": None}) for count in (50, 5)]
    specification = {"expect": [{"metric": "frames", "equals": 600}], "claims": [{"metric": "frames", "at_most": 1}]}
    for name in ("zoo", "ant"):
        database.list_experiment(sweep, name, "T", None, "", specification, points)
    for repeat in (1, 0):
        for key, status in (("p5", "ok"), ("p50", "timeout")):
            metrics = {"frames": (600, "1")} if status == "ok" else {}
            database.add_run(sweep, key, repeat, status, "exceeded 120 s", "", metrics, True)  # type: ignore[arg-type]


def test_a_shared_point_is_listed_under_each_experiment_in_order(database: Database, path: Path) -> None:
    fill(database)
    table = tables.runs(path)
    rows = list(zip(table["experiment"], table["count"], table["repeat"], table["status"], strict=True))
    each = [(50, 0, "timeout"), (50, 1, "timeout"), (5, 0, "ok"), (5, 1, "ok")]
    assert rows == [("ant", *row) for row in each] + [("zoo", *row) for row in each]


def test_experiments_can_be_chosen(database: Database, path: Path) -> None:
    fill(database)
    assert set(tables.runs(path, ["zoo", "no such"])["experiment"]) == {"zoo"}
    assert tables.runs(path, []).empty


def test_a_failed_run_is_a_row_without_numbers(database: Database, path: Path) -> None:
    fill(database)
    failed = tables.runs(path).query("status == 'timeout'")
    assert set(failed["reason"]) == {"exceeded 120 s"}
    assert failed["frames"].isna().all()


def test_criteria_that_were_not_judged_are_undecided(database: Database, path: Path) -> None:
    fill(database)
    ant, zoo = tables.experiments(path)
    assert [row.verdict for row in (*ant.expectations, *ant.claims)] == ["undecided", "undecided"]
    assert ant.claims[0].criterion == {"metric": "frames", "at_most": 1}
    assert zoo.sweep.finished is None


def test_verdicts_of_an_earlier_sweep_are_not_shown_for_a_newer_listing(database: Database, path: Path) -> None:
    first = database.begin_sweep("harness sweep", None, "0.1.0", {}, {})
    number = database.list_experiment(first, "e", "T", None, "", {"claims": [{"metric": "old"}]}, [])
    database.add_verdicts(first, number, "claim", [VerdictRow({"metric": "old"}, "holds", "old")])
    second = database.begin_sweep("harness sweep", None, "0.1.0", {}, {})
    database.list_experiment(second, "e", "T", None, "", {"claims": [{"metric": "new"}]}, [])
    (found,) = tables.experiments(path)[0].claims
    assert (found.criterion, found.verdict) == ({"metric": "new"}, "undecided")


def test_columns_have_the_types_to_compute_with() -> None:
    table = tables.run_table(
        [
            record(parameters={"count": 5, "size": {"uniform": [0.5, 1.5]}, "box": [1.0, 2.0, 3.0], "mesh": None}),
            record(parameters={"count": 6, "size": 1.0}, metrics={"energy_drift": 0.0}),
        ]
    )
    assert list(table) == [
        *("experiment", "point", "repeat", "status", "reason", "sweep", "timing_grade", "machine"),
        *("count", "size", "box", "mesh", "frames", "energy_drift"),
    ]
    assert table["count"].tolist() == [5, 6]
    assert table["count"].dtype == int
    assert table["frames"].dtype == float
    assert math.isnan(table["frames"][1])
    assert table["size"].tolist() == ['{"uniform": [0.5, 1.5]}', 1.0]
    assert table["box"][0] == "[1.0, 2.0, 3.0]"
    assert len(list(table.groupby(["size", "box"], dropna=False))) == 2


def test_a_table_of_no_runs_has_its_columns() -> None:
    table = tables.run_table([])
    assert table.empty
    assert list(table)[:4] == ["experiment", "point", "repeat", "status"]
