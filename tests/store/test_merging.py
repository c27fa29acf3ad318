"""Files brought together: nothing lost, nothing twice, machines kept apart."""

import shutil
import sqlite3

import pytest

from harness.cli.main import main
from harness.errors import InputError
from harness.store.database import Database
from harness.store.merging import merge
from harness.store.records import VerdictRow
from harness.store.tables import experiments, run_records, runs, sweeps
from tests.store.writing import GRID, TREE, add, begin, listed

TABLES = ("machine", "sweep", "point", "experiment", "run", "control", "metric", "claim", "comparison")


def content(path):
    """All rows of a file."""
    with sqlite3.connect(path) as connection:
        return {table: connection.execute(f"SELECT * FROM {table}").fetchall() for table in TABLES}


def write(path, cores, *points, seconds=1.0, name="first"):
    with Database.open(path) as database:
        sweep = begin(database, cores=cores)
        experiment = listed(database, sweep, *points, name=name)
        for point in points:
            add(database, sweep, point.key, 0, run_seconds=seconds)
            database.add_control(sweep, point.key, 0, "ok", {"run_seconds": seconds})
        database.add_verdicts(sweep, experiment, "claim", [VerdictRow({"metric": "x"}, "holds", "it holds")])
        database.add_comparison("harness compare", name, ("a", "b"), f"{cores}", {"pairs": []})
        database.finish_sweep(sweep)
    return path


@pytest.fixture
def two(tmp_path):
    """Results of two machines, that measured one point both and one point each."""
    one = write(tmp_path / "one.db", 2, GRID, TREE, seconds=1.0)
    other = write(tmp_path / "other.db", 64, GRID, seconds=5.0)
    with Database.open(other) as database:
        add(database, 1, GRID.key, 1, run_seconds=6.0)
    return one, other


def test_nothing_is_lost_and_the_others_are_left_alone(two):
    one, other = two
    before, left = content(one), content(other)
    merge(one, [other])
    after = content(one)
    assert content(other) == left
    for table in ("machine", "sweep", "run", "control", "metric", "claim", "comparison"):
        assert len(after[table]) == len(before[table]) + len(left[table]), table
    assert len(after["point"]) == 2
    assert len(after["experiment"]) == 1


def test_the_same_again_changes_nothing_and_the_order_does_not_matter(two, tmp_path):
    one, other = two
    mirrored = shutil.copy(other, tmp_path / "mirrored.db")
    merge(mirrored, [one])
    merge(one, [other])
    once = content(one)
    assert merge(one, [other]).runs == (4, 4)
    assert content(one) == once
    assert {table: len(rows) for table, rows in content(mirrored).items()} == {
        table: len(rows) for table, rows in once.items()
    }


def test_repeats_of_two_machines_are_not_mixed(two):
    one, other = two
    merge(one, [other])
    shown = [(record.point, record.repeat, record.metrics["run_seconds"]) for record in run_records(one)]
    of_grid = {seconds for key, _, seconds in shown if key == GRID.key}
    assert of_grid in ({1.0}, {5.0, 6.0})  # both began in the same second: either may be the last
    assert runs(one).groupby("point")["machine"].nunique().max() == 1


def test_a_sweep_that_goes_on_after_it_was_copied_is_known_again(two, tmp_path):
    one, _ = two
    copy = shutil.copy(one, tmp_path / "copy.db")
    with Database.open(one) as database:
        add(database, 1, TREE.key, 1, run_seconds=2.0)
    merged = merge(copy, [one])
    assert merged.sweeps == (1, 1)
    assert merged.runs == (2, 3)


def test_sweeps_of_one_second_stay_apart(tmp_path):
    path = write(tmp_path / "a.db", 2, GRID)
    write(path, 2, GRID, seconds=2.0)
    other = write(tmp_path / "b.db", 2, TREE, name="second")
    merge(path, [other])
    assert len(sweeps(path)) == 3
    assert {record.name for record in experiments(path)} == {"first", "second"}
    assert [record.metrics["run_seconds"] for record in run_records(path, ["first"])] == [2.0]


def test_a_merged_file_takes_further_sweeps(two):
    one, other = two
    merge(one, [other])
    with Database.open(one) as database:
        sweep = begin(database, cores=2)
        listed(database, sweep, GRID, TREE)
        add(database, sweep, GRID.key, 0, run_seconds=9.0)
    assert [record.metrics["run_seconds"] for record in run_records(one) if record.point == GRID.key] == [9.0]


def test_a_file_is_not_added_to_itself_and_what_is_no_results_is_refused(two, tmp_path):
    one, _ = two
    before = content(one)
    with pytest.raises(InputError, match="is the file that is added to"):
        merge(one, [one])
    (tmp_path / "text.db").write_text("no database")
    with pytest.raises(InputError):
        merge(one, [tmp_path / "text.db"])
    assert content(one) == before


def test_the_command_says_what_was_added(two, capsys):
    first, second = two
    assert main(["merge", str(first), str(second)]) == 0
    assert "1 sweep and " in capsys.readouterr().out
