"""Which runs a sweep does: the missing ones, those that failed, some, all again; and what it would do."""

import sqlite3

import pytest

from harness.cli.main import main
from harness.store import tables

EXPERIMENT = """
title: Which
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.2}
sweep: {count: [2, 4, 8], algorithm: [brute-force, grid]}
measure: {repeats: 2}
"""


@pytest.fixture
def which(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "which.yaml").write_text(EXPERIMENT)
    return tmp_path


def sweep(capsys, *words, code=0):
    capsys.readouterr()
    assert main(["sweep", "which.yaml", *words]) == code
    return capsys.readouterr().out


def rows():
    with sqlite3.connect("results/results.db") as connection:
        return connection.execute("SELECT point, repeat, status, sweep FROM run ORDER BY id").fetchall()


@pytest.mark.slow
def test_only_runs_points_with_these_values_and_the_rest_later(which, capsys):
    assert "4 runs done" in sweep(capsys, "--only", "count=8")
    assert "2 runs done (2 ok), 2 kept" in sweep(
        capsys, "--only", "count=8", "--only", "count=4", "--only", "algorithm=grid"
    )
    assert "6 runs done (6 ok), 6 kept" in sweep(capsys)
    assert len(tables.experiments("results/results.db")[0].points) == 6  # what was left out was still listed


@pytest.mark.slow
def test_only_can_choose_by_derived_parameters(which, capsys):
    assert "12 runs done" in sweep(capsys, "--only", "faces=0")


@pytest.mark.parametrize(
    ("only", "said"),
    [
        ("cuont=8", 'did you mean "count"?'),
        ("count", "must be LEAF=VALUE"),
        ("count=9", "no point of these experiments"),
    ],
)
def test_only_what_does_not_exist_is_an_error(which, capsys, only, said):
    assert main(["sweep", "which.yaml", "--only", only]) == 2
    assert said in capsys.readouterr().err


def test_retry_does_the_failed_runs_again_and_keeps_the_first_rows(which, capsys):
    crowded = ["--set", "count=[2, 500]"]
    assert "8 runs done (4 ok, 4 rejected)" in sweep(capsys, *crowded, code=1)
    assert "0 runs done, 8 kept" in sweep(capsys, *crowded, code=1)
    assert "4 runs done (4 rejected), 4 kept" in sweep(capsys, *crowded, "--retry", "failed", code=1)
    assert len(rows()) == 12


@pytest.mark.slow
def test_fresh_does_everything_again_and_goes_on_where_it_was_broken_off(which, capsys, monkeypatch):
    sweep(capsys)
    assert "12 runs done (12 ok), 0 kept" in sweep(capsys, "--fresh")
    assert len(rows()) == 24

    monkeypatch.setattr("sys.argv", ["harness", "sweep", "which.yaml", "--fresh"])
    with monkeypatch.context() as broken:
        broken.setattr("harness.cli.progress.Progress.after", interrupted_after(5))
        assert main(["sweep", "which.yaml", "--fresh"]) == 130
        assert "To go on: harness sweep which.yaml --fresh" in capsys.readouterr().err
    assert "7 runs done (7 ok), 5 kept" in sweep(capsys, "--fresh")  # not the five again
    assert "12 runs done (12 ok), 0 kept" in sweep(capsys, "--fresh")  # but this is a new one


def interrupted_after(runs):
    """A watcher's `after` that is interrupted at the end of so many runs."""
    seen = []

    def after(self, job, report):
        seen.append(job)
        if len(seen) == runs:
            raise KeyboardInterrupt

    return after


def test_a_dry_run_says_what_would_be_done_and_how_long_and_does_nothing(which, capsys):
    assert "12 runs to do, 0 kept from before: no such run was done before" in sweep(capsys, "--dry-run")
    assert not (which / "results").exists()
    sweep(capsys, "--only", "count=8")
    before = rows()
    told = sweep(capsys, "--dry-run")
    assert "8 runs to do, 4 kept from before: about" in told
    assert "from earlier runs of 0 of them" in told
    assert "which" in told
    assert "from earlier runs of 12 of them" not in told
    assert "12 runs to do, 0 kept from before: about" in sweep(capsys, "--dry-run", "--fresh")
    assert "nothing to do" in sweep(capsys, "--dry-run", "--only", "count=8")
    assert rows() == before


@pytest.mark.slow
def test_a_control_is_run_where_methods_are_compared_and_is_no_row(which, capsys):
    assert "30 runs done (30 ok), 0 kept from before\n5 of them done twice" in sweep(capsys, "--set", "repeats=5")
    assert len(rows()) == 30
    controls = tables.controls("results/results.db")
    assert sorted(control.repeat for control in controls) == [0, 1, 2, 3, 4]
    assert len({control.point for control in controls}) == 5  # spread over the points
    assert all(control.metrics["run_seconds"] > 0 for control in controls)
    assert "twice" not in sweep(capsys, "--set", "repeats=5")
    assert "twice" not in sweep(capsys, "--set", "repeats=5", "--set", "algorithm=tree")  # one method


@pytest.mark.slow
def test_an_experiment_that_takes_other_paths_says_the_command_that_goes_on(which, capsys, monkeypatch):
    monkeypatch.setattr("sys.argv", ["harness", "sweep", "which.yaml", "--set", "dt=1/30 "])
    monkeypatch.setattr("harness.cli.progress.Progress.before", interrupt)
    assert main(["sweep", "which.yaml", "--set", "dt=1/30 "]) == 130
    assert "To go on: harness sweep which.yaml --set 'dt=1/30 '" in capsys.readouterr().err


def interrupt(self, job):
    raise KeyboardInterrupt
