"""What needs a package that is not installed is passed over and said so: whole experiments, or some of their points."""

import json

import pytest

from harness.cli.main import main

LACKING = "title: Duck\nscene: {mesh: 'package:no_such_package/duck.obj', count: 2, box: [4, 4, 4]}\n"
WHOLE = "title: Spheres\nscene: {shape: sphere, count: 2, box: [4, 4, 4]}\nmotion: {duration: 0.1}\n"
TWO = """
title: Two libraries
scene: {shape: sphere, count: 2, box: [4, 4, 4]}
motion: {duration: 0.1}
zip:
  - {backend: [fcl, coal], algorithm: [grid, native]}
"""
SAID = 'experiments/duck.yaml:2:15: the package "no_such_package" is not installed'


@pytest.fixture
def experiments(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "experiments"
    folder.mkdir()
    (folder / "duck.yaml").write_text(LACKING)
    return folder


def test_it_is_valid_and_what_it_lacks_is_said(experiments, capsys):
    assert main(["validate", "experiments"]) == 0
    assert capsys.readouterr().out.splitlines() == [f"{SAID}; what needs it is passed over"]


def test_a_sweep_does_the_others(experiments, capsys):
    (experiments / "spheres.yaml").write_text(WHOLE)
    assert main(["sweep", "--dry-run"]) == 0
    said = capsys.readouterr()
    assert f"{SAID}; its points are passed over" in said.err
    assert "duck" not in said.out
    assert "spheres" in said.out


def test_alone_it_leaves_nothing_to_do(experiments, capsys):
    assert main(["sweep", "--dry-run"]) == 2
    assert SAID in capsys.readouterr().err


def test_the_list_says_it(experiments, capsys):
    assert main(["list", "--json"]) == 0
    [row] = json.loads(capsys.readouterr().out)["experiments"]
    assert (row["problems"], row["missing"]) == (0, 'the package "no_such_package" is not installed')


def test_what_brings_the_meshes_of_pybullet_is_named(experiments, capsys, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda *_: None)
    (experiments / "duck.yaml").write_text(LACKING.replace("no_such_package", "pybullet_data"))
    assert main(["validate", "experiments"]) == 0
    assert "pip install 'harness[pybullet]' brings it" in capsys.readouterr().out


def test_a_plan_passes_over_the_points_of_a_library_that_is_not_installed(experiments, capsys, monkeypatch):
    why = 'backend "coal" cannot be used: not installed'
    monkeypatch.setattr("harness.backends.statement.missing", lambda name: why if name == "coal" else None)
    (experiments / "two.yaml").write_text(TWO)
    assert main(["plan", "experiments/two.yaml"]) == 0
    said = capsys.readouterr().out
    assert f"points passed over: {why}" in said
    assert main(["plan", "experiments/two.yaml", "--json"]) == 0
    [run] = json.loads(capsys.readouterr().out)["runs"]
    assert run["parameters"]["backend"] == "fcl"
