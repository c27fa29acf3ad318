"""The main job through the real commands: sweep, resume, trace, plan, export."""

import json
import subprocess
import sys

import pytest

import harness
from harness.cli.main import main
from harness.runner import scene_of_point
from harness.store.recording import recording_of

EXPERIMENT = """
title: Small
question: Does it work?
scene: {mesh: cube.ply, shape: hull, count: 6, box: [6, 6, 6]}
motion: {duration: 1}
sweep: {count: [2, 4, 8, 16]}
zip: [{backend: [fcl, pybullet], algorithm: [brute-force, native]}]
measure: {repeats: 2}
expect:
  - {metric: energy_drift, at_most: 1.0e-12}
claims:
  - {metric: pair_tests, where: {backend: fcl}, exponent_of: count, between: [1.9, 3]}
"""


@pytest.fixture
def small(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(EXPERIMENT)
    return tmp_path


def exported(capsys):
    capsys.readouterr()
    assert main(["export", "--format", "json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_a_sweep_keeps_every_run_and_the_next_does_only_what_is_missing(small, capsys):
    assert main(["sweep", "small.yaml"]) == 0
    assert "16 runs done (16 ok), 0 kept" in capsys.readouterr().out
    assert main(["sweep", "small.yaml", "--set", "repeats=3"]) == 0
    assert "8 runs done (8 ok), 16 kept" in capsys.readouterr().out

    document = exported(capsys)
    runs = document["runs"]
    assert len(runs) == 24
    for run in runs:
        count, metrics = run["parameters"]["count"], run["metrics"]
        assert run["experiment"] == "small"
        assert run["status"] == "ok"
        assert metrics["frames"] == 60
        assert metrics["box_tests"] == 6 * 60 * count
        assert run["parameters"]["hull_vertices"] == 8
        if run["parameters"]["backend"] == "fcl":
            assert metrics["pair_tests"] == 60 * count * (count - 1) // 2
        assert metrics["run_seconds"] >= metrics["pair_seconds"] > 0
    counters = {(run["parameters"]["count"], run["parameters"]["backend"]): set() for run in runs}
    for run in runs:
        counted = (run["metrics"]["pair_hits"], run["metrics"]["box_hits"])
        counters[run["parameters"]["count"], run["parameters"]["backend"]].add(counted)
    assert all(len(seen) == 1 for seen in counters.values())  # a repeat repeats every event
    assert all(counters[count, "fcl"] == counters[count, "pybullet"] for count in (2, 4, 8, 16))
    assert [claim["verdict"] for claim in document["claims"]] == ["holds"]
    assert [row["verdict"] for row in document["expectations"]] == ["holds"]
    shown = recording_of("results/results.db", "small")  # the fullest scene, for its page
    assert shown.parameters["count"] == 16
    assert counters[16, "fcl"] == {
        (int((shown.recording.hit_walls < 0).sum()), int((shown.recording.hit_walls >= 0).sum()))
    }


@pytest.mark.slow
def test_a_failed_run_is_a_row_with_its_reason_and_the_exit_code_says_so(small, capsys):
    assert main(["sweep", "small.yaml", "--set", "count=500", "--set", "box=[4, 4, 4]"]) == 1
    runs = exported(capsys)["runs"]
    assert {run["status"] for run in runs} == {"rejected"}
    assert all("overlap" in run["reason"] for run in runs)
    assert main(["sweep", "small.yaml", "--set", "count=500", "--set", "box=[4, 4, 4]"]) == 1  # and it stays so


@pytest.mark.slow
def test_an_expectation_that_fails_is_named_and_exits_1(small, capsys):
    text = EXPERIMENT.replace("energy_drift, at_most: 1.0e-12", "frames, at_most: 59")
    (small / "small.yaml").write_text(text)
    assert main(["sweep", "small.yaml", "--set", "count=2"]) == 1
    assert "small: expectation fails: frames" in capsys.readouterr().out


@pytest.mark.slow
def test_experiments_share_the_runs_of_a_point(small, capsys):
    (small / "other.yaml").write_text(EXPERIMENT.replace("title: Small", "title: Other"))
    assert main(["sweep", "small.yaml", "other.yaml", "--set", "count=2"]) == 0
    assert "4 runs done" in capsys.readouterr().out
    assert len(exported(capsys)["runs"]) == 8


def test_a_long_experiment_runs_only_when_asked_for(small, capsys):
    assert main(["sweep", "small.yaml", "--set", "tier=long", "--set", "count=2"]) == 0
    output = capsys.readouterr()
    assert "0 runs done" in output.out
    assert "--long" in output.err


def test_trace_prints_one_json_document(small, capsys):
    assert main(["trace", "small.yaml", "--json", "--set", "count=12", "--set", "duration=4"]) == 0
    document = json.loads(capsys.readouterr().out)
    events = document["events"]
    assert set(document) == {"events", "final", "counters"}
    assert len(events) == document["counters"]["events"] > 0
    assert {event["kind"] for event in events} <= {"pair", "wall"}
    states = {"positions", "velocities_before", "velocities_after", "impulses"}
    assert all(set(event) == {"time", "kind", "bodies"} | states for event in events if event["kind"] == "pair")
    assert all(event["wall"] in ("x-", "x+", "y-", "y+", "z-", "z+") for event in events if event["kind"] == "wall")
    assert [event["time"] for event in events] == sorted(event["time"] for event in events)
    assert document["final"]["time"] == pytest.approx(4.0)
    assert len(document["final"]["position"]) == len(document["final"]["velocity"]) == 12


@pytest.mark.slow
def test_plan_says_what_is_left_out_and_warns_of_approximations(small, capsys):
    settings = ["--set", "shape=mesh", "--set", "backend=pybullet", "--set", "algorithm=native", "--set", "spin=0"]
    assert main(["plan", "small.yaml", *settings]) == 0
    text = capsys.readouterr().out
    assert "WARNING" in text
    assert "convex hull" in text
    assert main(["plan", "small.yaml", "--json", *settings]) == 0
    runs = json.loads(capsys.readouterr().out)["runs"]
    assert len(runs) == 4
    stages = {stage["name"]: stage for stage in runs[0]["stages"]}
    assert not stages["orientations"]["kept"]
    assert "spin" in stages["orientations"]["why"]


def test_plan_places_the_bodies_of_a_scene_once_for_all_methods(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "spheres.yaml").write_text(
        "title: Spheres\nscene: {shape: sphere, count: 3, box: [6, 6, 6]}\nmotion: {duration: 1}\n"
        "sweep: {count: [2, 3], algorithm: [grid, brute-force, predictive]}\n"
    )
    built, build = [], scene_of_point.build_scene
    monkeypatch.setattr(
        scene_of_point, "build_scene", lambda point, *more: built.append(point.scene.count) or build(point, *more)
    )
    assert main(["plan", "spheres.yaml", "--json"]) == 0
    runs = json.loads(capsys.readouterr().out)["runs"]
    assert built == [2, 3]
    assert [(run["parameters"]["count"], run["parameters"]["algorithm"]) for run in runs] == [
        (count, algorithm) for count in (2, 3) for algorithm in ("grid", "brute-force", "predictive")
    ]


@pytest.mark.slow
def test_python_gives_the_same_counts_as_the_commands(small):
    experiment = harness.load("small.yaml", count=8, repeats=1)
    table = harness.run(experiment)
    assert table["status"].tolist() == ["ok", "ok"]
    traced = harness.trace(experiment)
    assert table["events"].tolist()[0] == len(traced.times)
    assert main(["sweep", "small.yaml", "--set", "count=8", "--set", "repeats=1"]) == 0
    kept = harness.results("results/results.db")
    assert sorted(kept["events"]) == sorted(table["events"])
    assert set(table.columns) == set(kept.columns)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["sweep", "missing.yaml"], "no such file"),
        (["trace", "small.yaml", "--set", "cuont=3"], 'did you mean "count"?'),
        (["sweep", "small.yaml", "--set", "mesh=pumkin.ply"], "mesh"),
        (["export", "--db", "none.db"], "no such file"),
        (["plan", "small.yaml", "--set", "stages={pairs: off}"], "stages"),
    ],
)
def test_wrong_input_is_a_sentence_and_exit_2(small, capsys, words, said):
    assert main(words) == 2
    output = capsys.readouterr()
    assert said in output.err
    assert "Traceback" not in output.err
    assert output.out == ""


def test_the_module_is_the_command():
    ran = subprocess.run([sys.executable, "-m", "harness", "--help"], capture_output=True, text=True, check=True)
    assert "harness COMMAND --help" in ran.stdout
