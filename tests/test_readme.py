"""What the README tells people to type works as it stands there."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.backends.fcl import Fcl
from harness.backends.protocol import Backend
from harness.cli.main import COMMANDS, main
from harness.experiment.load import load_text
from harness.runner.scene_of_point import build_scene
from harness.scene.mesh_file import read_mesh
from harness.scene.poses_file import read_poses
from harness.scene.scene_files import SceneFiles

README = Path(__file__).parents[1] / "README.md"


def blocks(heading: str, language: str = "") -> list[str]:
    """The fenced blocks below a heading."""
    section = README.read_text(encoding="utf-8").split(f"\n## {heading}\n", 1)[1].split("\n## ", 1)[0]
    return re.findall(rf"^```{language}\n(.*?)^```", section, re.MULTILINE | re.DOTALL)


def commands(text: str) -> list[list[str]]:
    """Every `harness` command of a text, without what it says after a hash."""
    lines = [line.split("#", 1)[0] for line in text.splitlines()]
    return [
        shlex.split(part)[1:] for line in lines for part in line.split("&&") if re.match(r"\s*(\S*/)?harness ", part)
    ]


def test_every_command_named_exists():
    spoken = re.findall(r"`harness (\w+)", README.read_text(encoding="utf-8"))
    typed = [words[0] for fence in re.findall(r"^```\n(.*?)^```", README.read_text(encoding="utf-8"), re.M | re.S)
             for words in commands(fence)]  # fmt: skip
    assert spoken
    assert typed
    assert set(spoken + typed) <= COMMANDS.keys()


@pytest.mark.slow
def test_an_experiment_is_added_as_it_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    *before, sweep, _ = commands(blocks("Add an experiment")[0])
    assert [words[0] for words in before] == ["new", "validate", "plan"]
    assert [main(words) for words in before] == [0, 0, 0]
    assert main([*sweep, "--dry-run"]) == 0


def test_the_backend_that_it_shows_is_one_and_agrees_with_fcl():
    namespace: dict[str, object] = {}
    exec(blocks("Add a backend", "python")[0], namespace)
    mine, fcl = namespace["Mine"](), Fcl()
    assert isinstance(mine, Backend)
    text = "title: t\nscene: {shape: sphere, count: 40, box: [4, 4, 4], overlap: allow}\n"
    scene = build_scene(load_text(text, "readme.yaml").points[0], SceneFiles())
    for backend in (mine, fcl):
        backend.load(scene)
    found = [backend.pairs(scene.bodies.positions, scene.bodies.quaternions) for backend in (mine, fcl)]
    assert len(found[0]) > 10
    np.testing.assert_array_equal(*found)


SCENE_XML = """
<mujoco>
  <option timestep="0.01"/>
  <asset><mesh name="duck" file="{file}"/></asset>
  <worldbody>
    <body pos="0 0 1" quat="0.8 0.4 0.2 0.4"><freejoint/><geom type="mesh" mesh="duck"/></body>
    <body pos="0 0 5"><freejoint/><geom type="mesh" mesh="duck"/></body>
  </worldbody>
</mujoco>
"""


FRAME = 60  # of the recording, in which turned bodies have fallen


def bounds_in_pybullet(namespace):
    """Where each body begins and ends along the axes in the frame, as pybullet places its vertices."""
    library = namespace["p"]
    for body, (at, turn) in zip(namespace["bodies"], namespace["poses"][FRAME], strict=True):
        corners = library.getMeshData(body, -1)[1]
        placed = np.array([library.multiplyTransforms(at, turn, corner, [0, 0, 0, 1])[0] for corner in corners])
        yield placed.min(axis=0), placed.max(axis=0)


def bounds_in_mujoco(namespace):
    """The same of MuJoCo, which has moved the origin of the mesh."""
    library, model, data = namespace["mujoco"], namespace["model"], namespace["data"]
    library.mj_resetData(model, data)
    for _ in range(FRAME):
        library.mj_step(model, data)
    library.mj_kinematics(model, data)
    corners = model.mesh_vert.astype(float)
    placed = [corners @ turn.reshape(3, 3).T + at for turn, at in zip(data.geom_xmat, data.geom_xpos, strict=True)]
    return [(body.min(axis=0), body.max(axis=0)) for body in placed]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "library", "count", "bounds", "margin"),
    [(0, "pybullet", 4, bounds_in_pybullet, 3e-3), (1, "mujoco", 2, bounds_in_mujoco, 1e-6)],
)
def test_a_recording_of_another_simulator_has_its_bodies_where_they_were(
    number, library, count, bounds, margin, tmp_path, monkeypatch, capsys
):
    pytest.importorskip(library)
    duck = Path(pytest.importorskip("pybullet_data").getDataPath()) / "duck.obj"
    monkeypatch.chdir(tmp_path)
    Path("scene.xml").write_text(SCENE_XML.format(file=duck))
    block = blocks("Bring a recording of your own simulator", "python")[number]
    assert len(block.splitlines()) <= 15
    namespace: dict[str, object] = {}
    exec(block.replace("3 * k]", "3 * k], baseOrientation=[0.4, 0.2, 0.4, 0.8]"), namespace)
    declared = f"{{mesh: package:pybullet_data/duck.obj, count: {count}, size: native}}"
    text = f"title: t\nscene: {declared}\nmotion: {{poses: fall.npz}}\nengine: {{algorithm: grid}}\n"
    Path("x.yaml").write_text(text)
    assert main(["trace", "x.yaml"]) == 0
    scene = build_scene(
        load_text(text, tmp_path / "x.yaml").points[0], SceneFiles((read_mesh(duck),), read_poses(Path("fall.npz")))
    )
    for body, box in enumerate(bounds(namespace)):
        w, x, y, z = scene.poses.quaternions[FRAME, body]
        assert min(abs(w), abs(x), abs(y), abs(z)) > 0.1 or (library, body) == ("mujoco", 1)
        turn = Rotation.from_quat([x, y, z, w])
        corners = turn.apply(scene.solid_of_body(body).vertices) + scene.poses.positions[FRAME, body]
        np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], box, atol=margin)


@pytest.mark.slow
def test_the_lines_for_python_run(monkeypatch):
    block = blocks("From Python", "python")[0]
    monkeypatch.chdir(README.parent)
    small = block.replace("count=[5, 10]", "count=[5], repeats=1, duration=0.2")
    assert small != block
    namespace: dict[str, object] = {}
    exec(small, namespace)
    assert len(namespace["table"]) == 3
    assert (np.diff(namespace["events"].times) >= 0).all()


def test_the_lines_for_python_about_two_bodies_run(monkeypatch):
    block = blocks("From Python", "python")[1]
    monkeypatch.chdir(README.parent)
    namespace: dict[str, object] = {}
    exec(block, namespace)
    assert namespace["hits"].tolist() == [False, True]
    assert namespace["gap"][0] > 0 == namespace["gap"][1] == namespace["times"][1]
    assert 0 < namespace["times"][0] < 1.5


def test_the_findings_are_ten_of_those_that_are_published():
    text, published = README.read_text(encoding="utf-8"), README.parent / "results" / "published"
    shown = text.split("<!-- findings -->\n", 1)[1].split("<!-- /findings -->", 1)[0].splitlines()
    everything = (published / "findings.md").read_text(encoding="utf-8").splitlines()
    assert set(shown) <= set(everything)
    assert shown[0] == everything[0]
    assert 5 <= sum(line.startswith("| ") for line in shown[1:]) - 1 <= 10
    pictures = re.findall(r"!\[[^\]]+\]\((\S+)\)", text)
    assert pictures
    assert all((README.parent / picture).is_file() for picture in pictures)
