"""Poses that another program recorded: flown as they are, by every method and query, or refused with a reason."""

import io
import json
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.cli.main import main
from harness.experiment.load import load_text
from harness.runner.execute import execute
from harness.scene.poses_file import read_poses
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene_files import SceneFiles
from tests.conftest import cube_mesh, make_bodies, random_scene

TEXT = """
title: Recorded
scene: {scene}
motion: {{poses: poses.npz}}
engine: {engine}
measure: {{repeats: 1}}
"""
RECORDED = Path(__file__).parents[2] / "experiments/recorded"


def poses(count=3, frames=5, seed=1):
    """Arrays of poses that are drawn at random."""
    rng = np.random.default_rng(seed)
    turns = rng.normal(size=(frames, count, 4))
    return {
        "time": np.sort(rng.uniform(0.0, 2.0, frames)),
        "positions": rng.normal(size=(frames, count, 3)),
        "quaternions": turns / np.linalg.norm(turns, axis=2, keepdims=True),
    }


def flown(arrays, scene, mesh=None, **engine):
    """The outcome of an experiment with poses."""
    asked = json.dumps({"backend": "fcl", "algorithm": "grid", **engine})
    recorded = RecordedPoses("poses.npz", *(np.asarray(arrays[name], float) for name in arrays), digest="x")
    Path("poses.npz").touch()
    experiment = load_text(TEXT.format(scene=scene, engine=asked), Path("x.yaml").absolute())
    return execute(experiment.points[0], SceneFiles(() if mesh is None else (mesh,), recorded), traced=True)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_spheres_that_pass_touch_in_the_frames_in_which_they_are_near():
    time = np.array([3.0, 3.5, 4.5, 4.75])
    positions = np.zeros((4, 2, 3))
    positions[:, 1, 0] = [2.0, 0.9, 0.5, 1.5]
    arrays = {"time": time, "positions": positions, "quaternions": np.tile([1.0, 0, 0, 0], (4, 2, 1))}
    found = flown(arrays, "{shape: sphere, count: 2}")
    assert (found.metrics["frames"], found.metrics["pair_hits"], found.metrics["pair_contacts"]) == (3, 1, 1)
    assert found.trace.times.tolist() == [0.5]
    assert "energy_drift" not in found.metrics


def test_between_poses_a_body_moves_at_constant_velocity_so_that_an_impact_has_its_time():
    positions = np.zeros((3, 2, 3))
    positions[:, 1, 0] = [3.0, 0.5, 3.0]
    arrays = {
        "time": np.array([0.0, 2.0, 3.0]),
        "positions": positions,
        "quaternions": np.tile([1.0, 0, 0, 0], (3, 2, 1)),
    }
    found = flown(arrays, "{shape: sphere, count: 2}", query="impact")
    assert found.trace.times == pytest.approx([2.0 * 2.0 / 2.5], abs=1e-12)


def test_poses_are_of_the_frame_of_the_mesh_file_and_native_bodies_as_large_as_in_it():
    mesh = cube_mesh()
    shifted = type(mesh)(**{**vars(mesh), "diameter": 2.0, "centre": (5.0, 0.0, 0.0)})
    turned = Rotation.from_euler("z", 90, degrees=True).as_quat()[[3, 0, 1, 2]]
    still = {"time": [0.0, 1.0], "quaternions": np.tile([[1.0, 0, 0, 0], turned], (2, 1, 1))}
    # the second is turned by a right angle: its middle is 5 m along y from the origin of its file
    edge = 2.0 / np.sqrt(3.0)
    for gap in (-1e-3, 1e-3):
        places = np.tile([[0.0, 0.0, 0.0], [5.0 + edge + gap, -5.0, 0.0]], (2, 1, 1))
        arrays = {"time": still["time"], "positions": places, "quaternions": still["quaternions"]}
        found = flown(arrays, "{shape: hull, mesh: cube.ply, count: 2, size: native}", shifted, query="collision")
        assert found.metrics["pair_hits"] + found.metrics["pair_contacts"] == (gap < 0)


@pytest.mark.slow
@pytest.mark.parametrize("query", ["collision", "tolerance", "distance", "impact"])
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_every_method_finds_the_same_in_a_recording(shape, query):
    arrays = poses(count=9, frames=12, seed=4)
    arrays["positions"] *= 0.8
    scene = f"{{shape: {shape}, mesh: cube.ply, count: 9, size: {{uniform: [0.4, 1.2]}}, ignore: [[0, 1], [3, 7]]}}"
    within = {"within": 0.1} if query in ("tolerance", "distance") else {}
    found = {
        name: flown(arrays, scene, cube_mesh(), algorithm=name, query=query, **within)
        for name in ("brute-force", "grid", "tree", "sap")
    }
    every = found["brute-force"]
    assert every.metrics["narrow_tests"] >= 34 * 11
    assert len(every.trace.times) > 10 or every.metrics["near_pairs"] > 10
    for one in found.values():
        assert one.metrics["event_digest"] == every.metrics["event_digest"]
        assert one.metrics.get("near_pairs") == every.metrics.get("near_pairs")


@pytest.mark.slow
def test_a_flight_that_is_recorded_has_the_hits_of_the_flight():
    scene = random_scene("hull", 10, 40.0, seed=2)
    bodies, time = scene.bodies, np.linspace(0.0, 2.0, 41)
    bodies = make_bodies(bodies.positions / 15.0, velocities=bodies.velocities, quaternions=bodies.quaternions)
    positions = bodies.positions + time[:, None, None] * bodies.velocities
    arrays = {"time": time, "positions": positions, "quaternions": np.tile(bodies.quaternions, (41, 1, 1))}
    own = (
        "["
        + ", ".join(
            f"{{position: {x}, velocity: {v}, orientation: {q}, size: 1}}"
            for x, v, q in zip(
                *(array.tolist() for array in (bodies.positions, bodies.velocities, bodies.quaternions)), strict=True
            )
        )
        + "]"
    )
    text = f"""
title: Flown
scene: {{shape: hull, mesh: cube.ply, box: [400, 400, 400], bodies: {own}}}
motion: {{duration: 2, dt: 0.05, response: none}}
engine: {{algorithm: grid}}
"""
    experiment = load_text(text, Path("y.yaml").absolute())
    expected = execute(experiment.points[0], SceneFiles((cube_mesh(),)), traced=True)
    found = flown(arrays, "{shape: hull, mesh: cube.ply, count: 10, size: 1}", cube_mesh())
    assert expected.metrics["pair_hits"] > 3
    assert found.trace.bodies.tolist() == expected.trace.bodies.tolist()
    assert found.trace.times == pytest.approx(expected.trace.times)


def spoiled(name, arrays):
    """A file that is not what poses are."""
    if name == "nan":
        arrays["positions"][2, 1, 0] = np.nan
    elif name == "shape":
        arrays["quaternions"] = arrays["quaternions"][:, :, :3]
    elif name == "times":
        arrays["time"][3] = arrays["time"][1]
    elif name == "length":
        arrays["quaternions"][1, 2] *= 1.00001
    elif name == "lacking":
        del arrays["time"]
    elif name == "pickled":
        arrays["time"] = np.array([None] * 5)
    elif name == "far":
        arrays["positions"][1, 1, 2] = 1e200
    np.savez("poses.npz", **arrays)
    if name == "truncated":
        content = Path("poses.npz").read_bytes()
        Path("poses.npz").write_bytes(content[: len(content) // 2])
    elif name == "text":
        Path("poses.npz").write_text("time, x, y, z\n")
    elif name == "large":
        with open("poses.npz", "ab") as file:
            file.truncate(2**30)
    elif name in HEADERS:  # the first bytes of an array are its own; the number of bytes stays
        content = Path("poses.npz").read_bytes()
        Path("poses.npz").unlink()
        with zipfile.ZipFile(io.BytesIO(content)) as before, zipfile.ZipFile("poses.npz", "w") as after:
            for array in before.namelist():
                header = HEADERS[name].ljust(118).encode() + b"\n" if array == "positions.npy" else b""
                data = before.read(array)
                after.writestr(array, data[:10] + header + data[10 + len(header) :] if header else data)
    elif name == "encrypted":
        content = Path("poses.npz").read_bytes()
        for sign, flag in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
            for found in re.finditer(sign, content):
                at = found.start() + flag
                content = content[:at] + bytes([content[at] | 1]) + content[at + 1 :]
        Path("poses.npz").write_bytes(content)
    elif name == "circle":
        Path("poses.npz").unlink()
        Path("poses.npz").symlink_to("circle.npz")


HEADERS = {
    "huge": f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({10**12}, 3, 3), }}",
    "vast": f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({10**30}, 3, 3), }}",
    "negative": "{'descr': '<f8', 'fortran_order': False, 'shape': (-5, 3, 3), }",
    "call": "{'descr': print(), 'fortran_order': False, 'shape': (5, 3, 3), }",
    "nested": "(" * 118,
}


WRONG = {
    "nan": r"positions\[2\] has a value that is not finite",
    "shape": r"quaternions must have the shape \(5, 3, 4\)",
    "times": r"times must grow; time\[3\] is",
    "length": r"quaternions\[1, 2\] has length 1.00001",
    "lacking": r"there is no array time \(f,\) in it; it has positions, quaternions",
    "pickled": "it holds pickled Python objects, which are not read",
    "truncated": "this is no .npz file, or it is cut short",
    "text": "this is no .npz file",
    "large": "1024 MiB are too large",
    "far": r"positions must be within 1e\+30, not 1e\+200",
    "huge": r"positions is cut short: 360 bytes of data for the shape \(1000000000000, 3, 3\)",
    "vast": "positions is cut short: 360 bytes of data for the shape",
    "negative": r"positions cannot have the shape \(-5, 3, 3\)",
    "call": "positions does not begin like an array that NumPy has written",
    "nested": "positions does not begin like an array that NumPy has written",
    "encrypted": "it is encrypted",
    "circle": 'there are no poses "circle.npz" beside the experiment',
    "count": "count.npz has poses of 3 bodies, not 4",
}


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_what_is_wrong_with_a_file_is_said_at_the_line_that_names_it(capsys):
    for name in WRONG:
        spoiled(name, poses())
        Path("poses.npz").rename(f"{name}.npz")
        count = 4 if name == "count" else 3
        text = f"title: t\nscene: {{shape: sphere, count: {count}}}\nmotion:\n  poses: {name}.npz\n"
        Path(f"{name}.yaml").write_text(text)
    assert main(["validate", "."]) == 2
    errors = capsys.readouterr().err
    for name, said in WRONG.items():
        assert re.search(rf"^{name}.yaml:4:10: .*{said}", errors, re.MULTILINE), name


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("motion: {poses: poses.npz, duration: 3}", "duration has no effect with poses, which tell all motion"),
        ("motion: {poses: poses.npz}\nengine: {algorithm: predictive}", "recorded poses are looked at frame by frame"),
        ("motion: {poses: ../poses.npz}", "lie outside of the experiment's folder"),
        ("motion: {poses: others.npz}", "there are no poses"),
        ("motion: {poses: poses.npz}\nmeasure: {reference: {tolerance: 1.0e-9}}", "a reference knows gaps of recorded"),
    ],
)
def test_what_has_no_use_with_poses_is_refused(text, said, capsys):
    np.savez("poses.npz", **poses())
    Path("x.yaml").write_text(f"title: t\nscene: {{shape: sphere, count: 3}}\n{text}\n")
    assert main(["validate", "x.yaml"]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_a_box_is_not_needed_and_the_plan_has_no_walls(capsys):
    np.savez("poses.npz", **poses())
    Path("x.yaml").write_text("title: t\nscene: {shape: sphere, count: 3}\nmotion: {poses: poses.npz}\n")
    assert main(["plan", "x.yaml"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "every frame takes those of poses.npz" in said
    assert "poses are recorded: there are no walls" in said


@pytest.mark.parametrize("name", ["bin", "bin-at-rest", "arm"])
def test_the_recordings_that_come_with_it_are_small_and_read(name):
    file = RECORDED / f"{name}.npz"
    assert file.stat().st_size <= 600_000
    frames, bodies = len(read_poses(file)), read_poses(file).bodies
    assert (frames, bodies) == {"bin": (200, 61), "bin-at-rest": (12, 61), "arm": (241, 13)}[name]
