"""The history of sweeps: machines apart, the drift of a machine taken out, steps named with their commits."""

import json

import numpy as np
import pytest

from harness.cli.diff import _change
from harness.cli.main import main
from harness.errors import InputError
from harness.report.history.history import history
from harness.report.history.page import points_table, sweeps_table
from harness.report.site import render
from harness.store.database import Database
from harness.store.records import PointRow

METHOD = {"backend": "fcl", "algorithm": "grid", "shape": "sphere"}
POINTS = [PointRow(f"key-{count}", {"count": count, **METHOD}) for count in range(5, 15)]


@pytest.fixture
def swept(tmp_path):
    """Writes sweeps of ten points, with drifts; the point of 9 bodies is 1.6 times as slow from the 5th on."""

    def write(drifts, machine=1, slower=9, repeats=3, points=POINTS):
        rng = np.random.default_rng(machine)
        with Database.open(tmp_path / "results.db") as database:
            for number, drift in enumerate(drifts):
                packages = {"numpy": "2.0" if number < 4 else "2.1"}
                sweep = database.begin_sweep("harness sweep", f"commit{number}", "0.1.0", {"cores": machine}, packages)
                database.list_experiment(sweep, "first", "A title", None, "title: A title", {}, points)
                for point in points:
                    count = point.parameters["count"]
                    step = 1.6 if count == slower and number >= 4 else 1.0
                    for repeat in range(repeats):
                        seconds = 1e-3 * count * drift * step * (1.0 + 0.01 * rng.standard_normal())
                        metrics = {"run_seconds": (seconds, "s"), "pair_tests": (count + 2.0 * (number >= 4), "1")}
                        database.add_run(sweep, point.key, repeat, "ok", None, None, metrics, True)
                database.finish_sweep(sweep)
        return tmp_path / "results.db"

    return write


def test_a_step_is_named_with_its_sweep_its_commits_and_its_ratio(swept):
    [machine] = history(swept([1.0, 1.1, 0.9, 1.2, 1.3, 1.0, 1.1, 1.0]))
    [(point, step)] = machine.steps
    assert point.parameters["count"] == 9
    assert (step.before.commit, step.sweep.commit) == ("commit3", "commit4")
    assert step.ratio == pytest.approx(1.6, rel=0.03)
    assert list(machine.drifts.values()) == pytest.approx([1.0, 1.1, 0.9, 1.2, 1.3, 1.0, 1.1, 1.0], rel=0.02)


def test_a_drift_of_the_machine_is_no_step(swept):
    [machine] = history(swept([1.0, 1.0, 1.0, 1.3, 1.3, 1.3, 1.3, 1.3], slower=None))
    assert machine.steps == []


def test_sweeps_of_other_points_have_no_drift_and_no_table_of_points(swept):
    others = [PointRow(f"other-{point.key}", point.parameters | {"dt": 0.01}) for point in POINTS]
    swept([1.0])
    [machine] = history(swept([1.0], points=others))
    assert list(machine.drifts.values()) == [1.0]
    assert [row[-1].text for row in sweeps_table(machine).rows] == ["1×", "–"]
    assert points_table(machine, "run_seconds") is None


def test_every_change_of_an_exact_count_is_a_step(swept):
    [machine] = history(swept([1.0] * 6), "pair_tests")
    assert len(machine.steps) == len(POINTS)
    assert {step.sweep.commit for _, step in machine.steps} == {"commit4"}


@pytest.mark.slow
def test_machines_are_kept_apart(swept):
    swept([1.0] * 5)
    machines = history(swept([30.0] * 5, machine=64))
    assert [len(machine.sweeps) for machine in machines] == [5, 5]
    assert [machine.facts["cores"] for machine in machines] == [1, 64]


def test_what_is_not_there_is_a_sentence(swept):
    path = swept([1.0] * 2)
    with pytest.raises(InputError, match="no metric"):
        history(path, "pear_seconds")
    with pytest.raises(InputError, match="no run of experiment"):
        history(path, experiments=["secnod"])


def test_the_command_and_the_page_say_the_same(swept, capsys):
    path = swept([1.0] * 8)
    assert main(["history", "--db", str(path)]) == 0
    said = capsys.readouterr().out
    assert "1.6 times as long from sweep 5 on; commit commit3 to commit4" in said
    assert "numpy 2.0 → 2.1" in said
    assert main(["history", "--db", str(path), "--json"]) == 0
    [machine] = json.loads(capsys.readouterr().out)["machines"]
    assert sum(len(point["steps"]) for point in machine["points"]) == 1
    page = dict(render(path))["history.html"]
    assert "commit3 → commit4" in page


def test_a_difference_as_markdown_has_a_row_for_what_changed(swept, capsys):
    path = swept([1.0] * 6, repeats=5)
    assert main(["diff", "4", "5", "--db", str(path), "--format", "markdown"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("**Sweep 4** (`commit3`) against **sweep 5** (`commit4`): 1 slower, 0 faster, 10 changed")
    assert said.count("| first (count ") == 11


def test_a_share_is_told_in_the_digits_that_differ_and_a_count_in_all():
    assert _change(0.0, 6 / 70) == "0 to 0.0857143"
    assert _change(0.1, 0.1 + 1e-12) == "0.1 to 0.100000000001"
    assert _change(1234567.0, 1234568.0) == "1234567 to 1234568"
