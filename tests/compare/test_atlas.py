"""The atlas: families are what they say, every wrong verdict counts, and a reproduction stands by itself."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.compare import families
from harness.compare.atlas import AtlasCell, survey
from harness.compare.budget import Budget
from harness.compare.families import family_poses
from harness.compare.judge import judge
from harness.compare.minimise import minimise
from harness.compare.outcome import Case
from harness.compare.script import LONGEST, reproduces, script_of
from harness.errors import InputError
from harness.experiment.load import load_text
from harness.scene.box import Box
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene import Scene
from harness.vocabulary import FAMILIES
from tests.compare import liars, recheck
from tests.compare.liars import install
from tests.conftest import cube_mesh

EXPERIMENTS = Path(__file__).parents[2] / "experiments"


def poses(family, shape="hull", count=24):
    return [
        (pose_set.scene, pose)
        for pose_set in family_poses(family, shape, (cube_mesh(),), count)
        for pose in pose_set.poses(pose_set.scene)
    ]


def test_every_family_of_the_vocabulary_has_its_poses_and_as_many_as_asked():
    assert families._FAMILIES.keys() | {"resting"} == FAMILIES.keys()
    for family in families._FAMILIES:
        for shape in ("sphere", "hull", "mesh"):
            assert len(poses(family, shape, 5)) == 5


def test_resting_bodies_are_asked_about_where_they_were_recorded():
    places = np.array(
        [[[0.0, 0, 0], [0.9, 0, 0], [5.0, 0, 0], [5.7, 0, 0]], [[0.0, 0, 0], [2.0, 0, 0], [5.0, 0, 0], [5.8, 0, 0]]]
    )
    turns = np.tile([1.0, 0.0, 0.0, 0.0], (2, 4, 1))
    recorded = RecordedPoses("x.npz", np.array([0.0, 0.1]), places, turns, "")
    bodies = recorded.at_start(np.ones(4), np.ones(4))
    scene = Scene("hull", (cube_mesh(),), bodies, Box(np.full(3, 20.0)), mesh_of=np.zeros(4, int), poses=recorded)
    (found,) = families.resting_poses(scene, 10)
    seen = [(pose.name, pose.positions[:, 0].tolist()) for pose in found.poses(found.scene)]
    assert seen == [
        ("bodies 0 and 1 at 0 s", [0.0, 0.9]),
        ("bodies 2 and 3 at 0 s", [5.0, 5.7]),
        ("bodies 2 and 3 at 0.1 s", [5.0, 5.8]),
    ]
    (fewer,) = families.resting_poses(scene, 2)
    assert [pose.name for pose in fewer.poses(fewer.scene)] == [seen[0][0], seen[1][0]]
    (without,) = families.resting_poses(replace(scene, ignored=np.array([[2, 3]])), 10)
    assert [pose.name for pose in without.poses(without.scene)] == [seen[0][0]]


def test_bodies_of_two_meshes_or_sizes_are_asked_about_together_with_their_like():
    places = np.arange(4.0)[None, :, None] * [0.5, 0, 0]
    recorded = RecordedPoses("x.npz", np.zeros(1), places, np.tile([1.0, 0, 0, 0], (1, 4, 1)), "")
    bodies = recorded.at_start(np.array([1.0, 1.0, 2.0, 1.0]), np.ones(4))
    meshes = cube_mesh(), replace(cube_mesh(), name="other")
    scene = Scene("mesh", meshes, bodies, Box(np.full(3, 20.0)), mesh_of=np.array([0, 0, 0, 1]), poses=recorded)
    found = list(families.resting_poses(scene, 100))
    assert sum(len(one.poses(one.scene)) for one in found) == 5
    assert sorted((len(one.scene.meshes), *one.scene.bodies.sizes.tolist()) for one in found) == [
        (1, 1.0, 1.0), (1, 1.0, 2.0), (2, 1.0, 1.0), (2, 2.0, 1.0),
    ]  # fmt: skip


@pytest.mark.slow
def test_a_stack_that_was_recorded_is_judged_of_every_engine(capsys):
    assert (
        main(["compare", str(EXPERIMENTS / "atlas" / "resting.yaml"), "--backends", "fcl,pybullet", "--every", "7"])
        == 0
    )
    told = capsys.readouterr().out
    assert "fcl: resting, hull of cube.ply: 6 verdicts, none wrong" in told
    assert "own: distance, resting, mesh of cube.ply: 6 verdicts, none wrong" in told


def test_the_family_of_resting_bodies_needs_recorded_poses():
    text = "title: t\nscene: {mesh: cube.ply, count: 2, box: [6, 6, 6]}\nmeasure: {families: [resting]}\n"
    with pytest.raises(InputError, match=r"x\.yaml:3:11: .*motion\.poses names none"):
        load_text(text, "x.yaml")


def test_poses_of_a_family_are_the_same_each_time():
    for (_, pose), (_, again) in zip(poses("aligned"), poses("aligned"), strict=True):
        assert np.array_equal(pose.positions, again.positions)
        assert np.array_equal(pose.quaternions, again.quaternions)


def test_a_contained_body_touches_as_a_hull_and_not_as_a_surface():
    for shape, touching in (("hull", True), ("mesh", False)):
        for scene, pose in poses("contained", shape, 6):
            truth = judge(scene, 0, 1, pose.positions, pose.quaternions)
            assert truth.touching == touching
            assert truth.contained == (shape == "mesh")


def test_grazing_poses_are_as_far_apart_as_they_say():
    for scene, pose in poses("grazing"):
        said = float(pose.name.rpartition(" ")[2])
        gap = judge(scene, 0, 1, pose.positions, pose.quaternions).gap
        # an overlap of edges may be less deep than along the normal that it was made by
        assert gap == pytest.approx(said, abs=1e-15, rel=1e-9) or said < gap <= 0


def test_a_rate_has_the_interval_of_clopper_and_pearson():
    cell = AtlasCell("a", "random", "hull", "m", verdicts=100, wrong=0)
    rate, low, high = cell.per_million
    assert (rate, low) == (0.0, 0.0)
    assert high == pytest.approx(1e6 * (1 - 0.025 ** (1 / 100)))


def test_an_engine_that_sees_no_overlap_is_wrong_about_all_of_them_and_fcl_about_none(tmp_path, monkeypatch):
    name = install("blind", tmp_path / "plugins", monkeypatch)
    found = survey("hull", cube_mesh(), ["deep", "contained"], 6, ["fcl", name], Budget())
    wrong = {(cell.engine, cell.family): (cell.verdicts, cell.wrong, cell.beyond) for cell in found.cells}
    assert wrong == {
        ("fcl", "deep"): (6, 0, 0), (name, "deep"): (6, 6, 6),
        ("fcl", "contained"): (6, 0, 0), (name, "contained"): (6, 6, 6),
    }  # fmt: skip
    assert {case.wrong for case in found.cases.values()} == {name}
    assert all(cell.deepest > 0.1 for cell in found.cells if cell.engine == name)


@pytest.mark.slow
def test_one_that_misses_overlaps_along_a_vertex_direction_is_found_by_the_aligned_family(tmp_path, monkeypatch):
    body = """
        def pairs(self, positions, quaternions):
            apart = positions[1] - positions[0]
            along = np.sort(np.abs(apart))
            found = super().pairs(positions, quaternions)
            return found[:0] if along[2] - along[0] < 1e-6 * along[2] and along[2] > 0.1 else found
    """
    monkeypatch.setitem(liars.LIARS, "blind-along-vertices", body)
    name = install("blind-along-vertices", tmp_path / "plugins", monkeypatch)
    found = survey("hull", cube_mesh(), ["random", "aligned"], 120, ["fcl", name], Budget())
    beyond = {cell.family: cell.beyond for cell in found.cells if cell.engine == name}
    assert beyond["random"] == 0
    assert beyond["aligned"] > 0


@pytest.mark.slow
def test_a_saved_atlas_has_a_row_a_family_and_a_proof_of_every_accusation(tmp_path, monkeypatch, capsys):
    name = install("blind", tmp_path / "plugins", monkeypatch)
    source = (EXPERIMENTS / "atlas/short.yaml").read_text(encoding="utf-8")
    source = source.replace("mesh: cube.ply", f"mesh: {EXPERIMENTS.parent / 'meshes/cube.ply'}")
    source = source.replace("[random, aligned, grazing, deep, contained, shared, sizes, far, units]", "[deep, random]")
    (tmp_path / "atlas.yaml").write_text(source.replace("family_poses: 220", "family_poses: 40"))
    into = tmp_path / "saved"
    command = ["compare", str(tmp_path / "atlas.yaml"), "--backends", f"fcl,{name}", "--set", "shape=hull"]
    assert main([*command, "--save", str(into), "--db", str(tmp_path / "r.db")]) == 1
    cells = (into / "cells.csv").read_text(encoding="utf-8").splitlines()
    assert cells[0].startswith("engine,family,shape,mesh,verdicts,wrong,beyond,deepest,seconds,failures,query")
    assert len(cells) == 1 + 2 * 2
    accusations = json.loads((into / "accusations.json").read_text(encoding="utf-8"))
    assert {row["engine"] for row in accusations} == {name}
    assert all(recheck.proven(row) for row in accusations)
    assert all((into / row["file"]).is_file() for row in accusations)
    elsewhere = [body | {"position": [9.0 * k, 0, 0]} for k, body in enumerate(accusations[0]["bodies"])]
    assert not recheck.proven(accusations[0] | {"bodies": elsewhere})


def wrong_about(name):
    """A case in which a library is said to be wrong; whether it is, the script finds out."""
    scene, pose = poses("deep", count=1)[0]
    scene = replace(scene, bodies=replace(scene.bodies, positions=pose.positions, quaternions=pose.quaternions))
    truth = judge(scene, 0, 1, pose.positions, pose.quaternions)
    return Case((name, "fcl"), name, (0, 1), truth, scene=scene, pose=pose, query_index=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["fcl", "pybullet", "mujoco", "trimesh", "coal", "rapier3d", "parry3d", "drake", "mujoco_warp"]
)
def test_a_reproduction_asks_the_library_and_checks_its_proof_and_one_that_shows_nothing_is_not_written(name, tmp_path):
    pytest.importorskip({"parry3d": "py_parry3d", "drake": "pydrake"}.get(name, name))
    from harness.compare.library_calls import CALLS
    from harness.compare.script import _written

    case = wrong_about(name)
    text = _written(case, CALLS[name, "hull"])
    assert text.count("\n") <= LONGEST
    path = tmp_path / "reproduction.py"
    path.write_text(text)
    ended = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert "says they touch" in ended.stdout
    assert ended.stdout.endswith("not reproduced: this version answers otherwise\n")
    assert script_of(case) is None


@pytest.mark.slow
def test_mujoco_far_away_is_reproduced_without_this_program():
    pytest.importorskip("mujoco")
    found = survey("hull", cube_mesh(), ["far"], 200, ["fcl", "mujoco"], Budget())
    (case,) = found.cases.values()
    assert case.wrong == "mujoco"
    text = script_of(minimise(case))
    assert "harness" not in text
    assert reproduces(text)
    assert not reproduces(text.replace("return data.ncon > 0", "return True"))
