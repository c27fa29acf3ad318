"""`validate`, `list` and `new`, through the real command line."""

import json
from pathlib import Path

import pytest

from harness.cli.main import main

GOOD = "title: t\nscene: {shape: sphere, count: 2, box_ratio: 1/9}\nsweep: {count: [1, 2]}\n"
TRIANGLES = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""


@pytest.fixture(autouse=True)
def _folder(folder: Path) -> None:
    (folder / "cube.ply").write_text(TRIANGLES)


def test_validate_says_what_a_sound_file_would_run(capsys: pytest.CaptureFixture[str]) -> None:
    Path("good.yaml").write_text(GOOD)
    assert main(["validate", "good.yaml", "--set", "repeats=3"]) == 0
    assert capsys.readouterr().out == "good: 2 points, 6 runs\n"


def test_a_stage_that_cannot_be_forced_is_told_where_it_stands(capsys: pytest.CaptureFixture[str]) -> None:
    Path("good.yaml").write_text(GOOD.replace("[1, 2]", "[1, 2], stages: [{}, {motion: on}]"))
    Path("names.yaml").write_text(GOOD + "engine:\n  algorithm: grid\n  stages: {pairs: on, wals: off}\n")
    Path("wrong.yaml").write_text(GOOD.replace("[1, 2]", "[1, 2], stages: [{}, {walls: off}]"))
    assert main(["validate", "good.yaml", "names.yaml", "wrong.yaml"]) == 2
    captured = capsys.readouterr()
    assert captured.out == "good: 4 points, 20 runs\n"
    alone, unknown, wrong = captured.err.splitlines()
    assert alone == "names.yaml:6:19: pairs cannot be forced on: there is no pair of bodies among 1"
    assert unknown == 'names.yaml:6:29: this pipeline has no stage "wals"; did you mean "walls"?'
    assert wrong == "wrong.yaml:3:45: walls cannot be forced off: bodies would leave the box"


def test_validate_says_everything_about_every_file(capsys: pytest.CaptureFixture[str]) -> None:
    Path("good.yaml").write_text(GOOD)
    Path("bad.yaml").write_text(GOOD + "motion: {dt: 0}\ndt: 3\n")
    Path("names.yaml").write_text(
        GOOD + "engine: {backend: pybulet}\nexpect: [{metric: energy_drfit, at_most: 1}]\n"
        "report: {y: [escaped, pair_secnds]}\n"
    )
    assert main(["validate", "good.yaml", "bad.yaml", "names.yaml"]) == 2
    captured = capsys.readouterr()
    assert captured.out == "good: 2 points, 10 runs\n"
    assert captured.err.splitlines() == [
        "bad.yaml:4:14: dt must be greater than 0, not 0",
        'bad.yaml:5:1: unknown key "dt"; it belongs under motion',
        'names.yaml:4:19: unknown backend "pybulet"; did you mean "pybullet"?',
        'names.yaml:5:19: unknown metric "energy_drfit"; did you mean "energy_drift"?',
        'names.yaml:6:23: unknown metric "pair_secnds"; did you mean "pair_seconds"?',
    ]


@pytest.mark.slow
def test_a_mesh_that_cannot_be_opened_is_an_error_where_it_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    Path("m.yaml").write_text("title: t\nscene:\n  count: 2\n  box_ratio: 1/9\nsweep:\n  mesh: [cube.ply, duck.obj]\n")
    assert main(["validate", "m.yaml"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("m.yaml:6:20: ")
    assert main(["validate", "m.yaml", "--set", "mesh=cube.ply"]) == 0


def test_two_files_of_one_name_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for folder in ("a", "b"):
        Path(folder).mkdir()
        Path(folder, "same.yaml").write_text(GOOD)
    assert main(["validate", "a", "b"]) == 2
    assert 'b/same.yaml:1:1: this is called "same" as a/same.yaml is' in capsys.readouterr().err


def test_a_wrong_set_is_said_once_for_all_files(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.yaml").write_text(GOOD)
    Path("b.yaml").write_text(GOOD)
    assert main(["validate", "a.yaml", "b.yaml", "--set", "count=abc"]) == 2
    assert capsys.readouterr().err == '--set count=abc: must be a whole number, not "abc"\n'
    assert main(["validate", "a.yaml", "--set", "count"]) == 2
    assert capsys.readouterr().err == "--set count: must be LEAF=VALUE, such as count=50\n"


def test_new_writes_an_experiment_that_is_sound_and_never_overwrites(capsys: pytest.CaptureFixture[str]) -> None:
    Path("meshes").mkdir()
    Path("meshes/pumpkin-1753.ply").write_text(TRIANGLES)
    assert main(["new", "homework/my-own"]) == 0
    path = Path("experiments/homework/my-own.yaml")
    assert 'title: "My own"' in path.read_text()
    assert f"harness sweep {path}" in capsys.readouterr().out
    assert main(["validate", str(path)]) == 0
    assert capsys.readouterr().out == "homework/my-own: 4 points, 20 runs\n"
    path.write_text("mine")
    assert main(["new", str(path)]) == 2
    assert path.read_text() == "mine"
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["../up", "/tmp/absolute", "", "a\nb", "cube.ply/x.yaml"])
def test_new_refuses_names_that_are_none(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", name]) == 2
    assert capsys.readouterr().err


def test_list_says_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    Path("experiments").mkdir()
    Path("experiments/good.yaml").write_text(GOOD)
    Path("experiments/bad.yaml").write_text("titel: t")
    assert main(["list"]) == 0
    out = capsys.readouterr().out
    assert "wrong: `harness validate experiments/bad.yaml` says how" in out
    assert main(["list", "--json"]) == 0
    listing = json.loads(capsys.readouterr().out)
    assert list(listing) == ["experiments", "backends", "algorithms", "queries", "metrics"]
    assert [row["runs"] for row in listing["experiments"]] == [None, 10]
    assert {"fcl", "pybullet"} <= {row["name"] for row in listing["backends"]}
    assert {"name": "pair_tests", "unit": "1"}.items() <= next(
        row for row in listing["metrics"] if row["name"] == "pair_tests"
    ).items()


def test_list_prints_the_schema(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out)["additionalProperties"] is False
