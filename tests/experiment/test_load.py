"""Files, overrides, names, and all problems at once."""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.experiment.experiment import Experiment
from harness.experiment.files import find_experiments, name_of
from harness.experiment.load import load

Read = Callable[..., Experiment]
ProblemsIn = Callable[..., list[str]]

SWEPT = """title: t
scene: {shape: sphere, count: 2, box_ratio: 1/9}
sweep: {count: [5, 6]}
zip: [{dt: [1/60, 1/30], size: [1, 2]}]
include: [{count: 9, seed: 1}]
exclude: [{count: 6, size: 2}]
"""


def points(read: Read, *leaves: str, **set: object) -> list[tuple[object, ...]]:
    return [tuple(point.parameters[leaf] for leaf in leaves) for point in read(SWEPT, **set).points]


def test_all_problems_are_said_at_once_in_the_order_of_the_file(problems_in: ProblemsIn) -> None:
    messages = problems_in(
        "titel: t\nscene: {cuont: 5, size: -1, box_ratio: 1}\nmotion: {dt: 1/0}\nexpect: 3\nmotion: {}\n"
    )
    assert [message.split(" ")[0] for message in messages] == [
        "exp.yaml:1:1:",
        "exp.yaml:1:1:",
        "exp.yaml:2:1:",
        "exp.yaml:2:1:",
        "exp.yaml:2:9:",
        "exp.yaml:2:25:",
        "exp.yaml:3:14:",
        "exp.yaml:4:9:",
        "exp.yaml:5:1:",
    ]


@pytest.mark.slow
def test_a_flood_of_problems_is_cut_short(problems_in: ProblemsIn) -> None:
    messages = problems_in("\n".join(f"key{i}: 1" for i in range(5000)))
    assert len(messages) == 101
    assert messages[-1].startswith("exp.yaml:97:1: and 4904 problems more")


def test_set_replaces_a_value_of_any_section(read: Read) -> None:
    text = "title: t\nscene: {shape: sphere, count: 2, box: [1, 1, 1]}\n"
    set = {"count": "50", "dt": "1/120", "algorithm": "grid", "repeats": "2", "title": "5", "question": "Is it: so?"}
    experiment = read(text, **set, speed="{uniform: [0, 1]}", memory="1GiB", response="elastic")
    (point,) = experiment.points
    assert (point.scene.count, point.motion.dt, point.engine.algorithm) == (50, 1 / 120, "grid")
    assert (experiment.measure.repeats, experiment.measure.memory) == (2, 2**30)
    assert (experiment.title, experiment.question) == ("5", "Is it: so?")
    assert point.scene.speed.values == (0.0, 1.0)
    assert experiment.overrides["count"] == "50"


def test_set_takes_values_from_python_too(read: Read) -> None:
    assert read(SWEPT, count=(7, 8), dt=0.5, size=1).points[0].motion.dt == 0.5


def test_set_on_a_swept_leaf_replaces_its_list(read: Read) -> None:
    assert {row[0] for row in points(read, "count", count="7")} == {7}
    assert points(read, "count", "size", count="[1, 2]", size="3", dt="1")[:2] == [(1, 3.0), (2, 3.0)]


def test_set_in_a_zip_block_keeps_its_length(read: Read, problems_in: ProblemsIn) -> None:
    assert set(points(read, "dt", "size", dt="[1, 2]")) == {(1.0, 1.0), (2.0, 2.0), (1 / 60, 1.0)}
    (message,) = problems_in(SWEPT, dt="[1, 2, 3]")
    assert message == "--set dt=[1, 2, 3]: needs 1 or 2 values, for it varies together with other leaves"


def test_set_of_one_value_wins_over_included_points(read: Read) -> None:
    assert {row[0] for row in points(read, "seed", seed="4")} == {4}


def test_set_of_several_values_makes_a_fixed_leaf_vary(read: Read) -> None:
    experiment = read("title: t\nscene: {shape: sphere, count: 2, box: [1, 1, 1]}", seed="[1, 2]")
    assert [point.scene.seed for point in experiment.points] == [1, 2]
    assert experiment.swept == ("seed",)


def test_set_takes_the_place_of_the_alternative(read: Read) -> None:
    assert set(points(read, "count", "bodies", bodies="[{position: [0, 0, 0]}]")[0][:1]) == {None}
    assert points(read, "box_ratio", box="[3, 3, 3]")[0] == (None,)


def test_an_exclude_that_matches_nothing_is_forgiven_where_leaves_are_set(read: Read) -> None:
    assert points(read, "count", count="5")


@pytest.mark.parametrize(
    ("leaf", "value", "message"),
    [
        ("count", "abc", '--set count=abc: must be a whole number, not "abc"'),
        ("count", "-1", "--set count=-1: must be at least 0, not -1"),
        ("cuont", "5", '--set cuont=5: unknown leaf "cuont"; did you mean "count"?'),
        ("expect", "[]", '--set expect=[]: "expect" cannot be set; only leaves can'),
        ("dt", "1/0", "--set dt=1/0: 1/0 divides by zero"),
        ("dt", "[1", "--set dt=[1: this is not YAML: "),
        ("seed", "[]", "--set seed=[]: needs at least one value"),
        ("repeats", "0", "--set repeats=0: must be at least 1, not 0"),
        ("title", "", "--set title=: must not be empty"),
        ("mesh", "nix.ply", '--set mesh=nix.ply: there is no mesh "nix.ply" beside the experiment or in meshes/'),
        ("algorithm", "native", "--set algorithm=native: backend fcl has no algorithm native, only brute-force, grid,"),
        ("count", 2.5, "--set count=2.5: must be a whole number, not 2.5"),
        ("count", "5\x1b[31m", "--set count=5\ufffd[31m: the character U+001B is not allowed"),
    ],
)
def test_a_wrong_set_is_said_as_it_was_typed(leaf: str, value: object, message: str, problems_in: ProblemsIn) -> None:
    (problem,) = problems_in(SWEPT, **{leaf: value})
    assert problem.startswith(message)


def test_a_missing_mesh_is_an_error_where_it_is_named(problems_in: ProblemsIn) -> None:
    base = "title: t\nscene: {count: 2, box_ratio: 1, mesh: cbe.ply}\n"
    missing = 'there is no mesh "cbe.ply" beside the experiment or in meshes/; did you mean "cube.ply"?'
    assert problems_in(base) == [f"exp.yaml:2:39: {missing}"]
    assert problems_in(base.replace("cbe", "cube") + "sweep: {mesh: [cube.ply, cbe.ply]}") == [
        f"exp.yaml:3:26: {missing}"
    ]


def test_meshes_are_located_once_a_reference(read: Read, folder: Path) -> None:
    experiment = read("title: t\nscene: {count: 2, box_ratio: 1}\nsweep: {mesh: [cube.ply, duck.obj], count: [1, 2]}")
    assert experiment.mesh_paths == {name: folder.resolve() / name for name in ("cube.ply", "duck.obj")}
    problem = experiment.leaf_problem("mesh", "duck.obj", "must be whole")
    assert str(problem) == "exp.yaml:3:26: mesh must be whole"
    assert str(experiment.problem(("scene", "box_ratio"), "is odd")) == "exp.yaml:2:30: is odd"


def test_the_name_is_the_path_below_experiments(folder: Path) -> None:
    assert name_of(Path("experiments/homework/size.yaml")) == "homework/size"
    assert name_of(Path("elsewhere/size.yaml")) == "size"
    assert name_of(folder / "experiments" / "a" / "experiments" / "b.yaml") == "b"
    (folder / "experiments" / "homework").mkdir(parents=True)
    os.chdir(folder / "experiments" / "homework")
    assert name_of(Path("size.yaml")) == "homework/size"


def test_files_that_cannot_be_read_say_why(folder: Path) -> None:
    (folder / "experiments").mkdir()
    (folder / "experiments" / "quick.yaml").write_text(SWEPT)
    for path, message in (
        ("quick", 'quick: there is no such file or folder; did you mean "experiments/quick.yaml"?'),
        (".", ".: this is a folder; name a file"),
        ("/dev/null", "/dev/null: this is not a file"),
        ("a" * 300, "a" * 300 + ": there is no such file or folder"),
    ):
        with pytest.raises(InputError) as caught:
            load(path)
        assert str(caught.value) == message
    assert load("experiments/quick.yaml").name == "quick"


def test_folders_are_searched_for_experiments(folder: Path) -> None:
    for name in ("b/two.yaml", "b/a/one.yaml", "three.yaml", "b/four.txt"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(SWEPT)
    (folder / "empty").mkdir()
    found = [str(path) for path in find_experiments(["b", "three.yaml", "b/two.yaml", "."])]
    assert found == ["b/a/one.yaml", "b/two.yaml", "three.yaml"]
    with pytest.raises(InputError) as caught:
        find_experiments(["empty", "there.yaml"])
    assert [str(problem) for problem in caught.value.problems] == [
        "empty: there is no experiment (*.yaml) in this folder",
        'there.yaml: there is no such file or folder; did you mean "three.yaml"?',
    ]


def test_an_experiment_can_be_sent_to_another_process(read: Read) -> None:
    experiment = read(SWEPT)
    assert pickle.loads(pickle.dumps(experiment)) == experiment


def test_markup_stays_text(read: Read) -> None:
    assert read(SWEPT.replace("title: t", "title: <script>alert(1)</script>")).title == "<script>alert(1)</script>"


def test_loading_imports_nothing_heavy() -> None:
    code = "import sys, harness.experiment.load, harness.experiment.json_schema; print(*sys.modules)"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"numpy", "pandas", "numba", "trimesh", "matplotlib"} & set(modules)


def test_every_problem_is_one_printable_line(problems_in: ProblemsIn) -> None:
    name = "a\\n\\tb" + "c" * 500
    messages = problems_in(
        f'title: t\n"{name}": 5\nscene: {{shape: "{name}", count: 1, box_ratio: 1}}\n'
        f'engine: {{stages: {{"{name}": 5}}}}\n'
        f'include: [{{"{name}": 1}}]\npublished: {{source: s, rows: [{{"{name}": .inf, a: .inf}}]}}\n'
    )
    assert len(messages) == 6
    for message in messages:
        assert message.isprintable()
        assert len(message) < 250
