"""Backends with a known defect are caught and named; sound ones are not accused."""

import json

import pytest

from harness.cli.main import main
from harness.compare.comparison import compare
from harness.compare.poses import flown
from tests.conftest import needs_pybullet, random_scene, slow_beyond
from tests.narrowphase.meshes import crowd, mesh_named

EXPERIMENT = """
title: Crowd
scene: {shape: SHAPE, MESH count: 20, box: [4, 4, 4], overlap: allow}
motion: {duration: 1, dt: 1/30, response: none}
"""


def written(folder, shape):
    mesh = "" if shape == "sphere" else "mesh: cube.ply,"
    path = folder / "crowd.yaml"
    path.write_text(EXPERIMENT.replace("SHAPE", shape).replace("MESH", mesh))
    return str(path)


def compared(capsys, *arguments):
    code = main(["compare", *arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull"])
def test_fcl_and_pybullet_have_no_real_disagreement(shape, tmp_path, capsys):
    code, document = compared(capsys, written(tmp_path, shape))
    assert code == 0
    assert document["cases"] == []
    (pair,) = document["pairs"]
    assert list(pair) == [
        *("backends", "shape", "poses", "verdicts"),
        *("agree", "undecided", "containment", "approximation", "real"),
    ]
    assert pair["backends"] == ["fcl", "pybullet"]
    kinds = ("agree", "undecided", "containment", "approximation", "real")
    assert pair["verdicts"] == sum(pair[kind] for kind in kinds) > 31 * 190


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count"),
    [("drops", 60), ("flips", 10), ("swaps", 10)],
)
def test_a_defect_is_caught_and_its_backend_named(name, count, defective, tmp_path, capsys):
    names = f"fcl,{defective(name)}"
    code, document = compared(capsys, written(tmp_path, "sphere"), "--backends", names, "--set", f"count={count}")
    assert code == 1
    (pair,) = document["pairs"]
    assert pair["real"] == len(document["cases"]) > 0
    for case in document["cases"]:
        assert case["wrong"] == name
        assert case["backends"] == ["fcl", name]
        assert abs(case["gap"]) > 0
        assert case["certificate"]["kind"]


@pytest.mark.parametrize("name", slow_beyond(["inflates", "unturned"]))
def test_a_defect_of_turned_shapes_is_caught_as_bodies_fly(name, defective):
    defective(name)
    found = compare([flown(random_scene("hull", 20, 3.0), 10, 0.1)], ["fcl", name])
    assert {case.wrong for case in found.cases} == {name}
    assert found.tallies[0].real == len(found.cases)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["crashes", "hangs"])
def test_a_backend_that_dies_at_a_pose_is_asked_the_others(name, defective):
    defective(name)
    scene = random_scene("sphere", 8, 3.5, seed=2)
    scene.bodies.velocities[:] = 0.0
    scene.bodies.positions[0] = [-1.0, 0.0, 0.0]
    scene.bodies.velocities[0] = [0.5, 0.0, 0.0]
    pose_set = flown(scene, 4, 0.1)
    deadly = sum(abs(pose.positions[0, 0]) > 0.9 for pose in pose_set.poses(scene))
    assert deadly == 2
    found = compare([pose_set], ["fcl", name], timeout=2.0)
    assert [(failure.backend, failure.query_index) for failure in found.failures] == [(name, 1), (name, 2)]
    assert ("SIGSEGV" if name == "crashes" else "no answer within 2 s") in found.failures[0].reason
    assert found.tallies[0].poses == 5 - deadly
    assert not found.passed


@needs_pybullet
def test_a_mesh_replaced_by_its_hull_is_an_approximation():
    scene = crowd(mesh_named("pumpkin-1753.ply"), "mesh", 12, 1.4, 0)
    found = compare([flown(scene, 3, 1 / 30)], ["fcl", "pybullet"])
    assert found.passed
    assert found.cases == []
    assert found.tallies[0].approximation > 0


def test_backends_that_there_are_not_are_an_error(tmp_path, capsys):
    assert main(["compare", written(tmp_path, "sphere"), "--backends", "fcl,pybulet"]) == 2
    assert 'did you mean "pybullet"' in capsys.readouterr().err
    assert main(["compare", written(tmp_path, "sphere"), "--backends", "fcl"]) == 2


@pytest.mark.slow
def test_a_backend_that_hangs_over_its_first_scene_is_not_asked_about_others(defective):
    said = []
    scene = random_scene("sphere", 3, 3.0)
    names = ("fcl", defective("hangs-loading"))
    found = compare([flown(scene, 2, 0.1)] * 3, names, said.append, timeout=0.2)
    assert found.unsupported == [
        "fcl and hangs-loading are not comparable on shape sphere: hangs-loading: it did not load the scene within "
        "2 s, and is not asked again"
    ]
    assert said == ["fcl, hangs-loading: 3 bodies, shape sphere"]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "how"), [("crashes-loading", "SIGSEGV"), ("raises-loading", "no luck")])
def test_a_backend_that_fails_over_every_scene_is_named_once_and_the_comparison_fails(
    name, how, defective, tmp_path, capsys
):
    names = f"fcl,{defective(name)},pybullet"
    arguments = ["--backends", names, "--set", "count=3", "--set", "dt=1/2", "--every", "50"]
    code, document = compared(capsys, written(tmp_path, "sphere"), *arguments)
    assert code == 1
    assert [(case["wrong"], how in str(case["certificate"])) for case in document["cases"]] == [(name, True)]
    assert ["fcl", "pybullet"] in [pair["backends"] for pair in document["pairs"] if pair["verdicts"]]
