"""Each backend against closed forms, and against each other."""

import dataclasses

import numpy as np
import pytest

from harness.backends import registry
from harness.backends.contract import ContractError
from harness.compare.hard_poses import hard_poses
from harness.compare.judge import judge
from harness.methods.registry import method_of
from harness.motion.law import MotionLaw
from harness.scene.box import Box
from harness.scene.scene import Scene
from harness.vocabulary import MethodName
from tests.conftest import cube_mesh, make_bodies, random_scene
from tests.narrowphase.meshes import mesh_named


def load(name, scene):
    backend = registry.create(name)
    backend.load(scene)
    return backend


def touching(name, scene):
    return load(name, scene).pairs(scene.bodies.positions, scene.bodies.quaternions).tolist()


def two_at(gap, shape, name, *, size=1.0, offset=0.0):
    """Two bodies whose surfaces are `gap` sizes apart along x, face to face where they are cubes."""
    width = 1.0 if shape == "sphere" else 1 / np.sqrt(3)
    positions = np.array([[offset, 0, 0], [offset + width + gap, 0.01, 0.02]]) * size
    if shape == "sphere":
        positions[1, 1:] = 0.0
    scene = Scene(shape, (cube_mesh(),), make_bodies(positions, sizes=[size, size]), Box(np.full(3, 100.0 * size)))
    return touching(name, scene)


@pytest.mark.parametrize("name", ["fcl", "pybullet"])
@pytest.mark.parametrize("shape", ["sphere", "hull"])
@pytest.mark.parametrize("size", [1e-4, 1.0, 1e6])
def test_a_gap_beyond_the_tolerance_decides(name, shape, size):
    band = max(2e-15, registry.create(name).tolerance(shape)) * 2
    assert two_at(band, shape, name, size=size) == []
    assert two_at(-band, shape, name, size=size) == [[0, 1]]


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull"])
@pytest.mark.parametrize("side", [10.0, 4.0])
def test_fcl_and_pybullet_see_the_same_pairs(shape, side):
    for seed in range(10):
        scene = random_scene(shape, 50, side, seed)
        assert touching("fcl", scene) == touching("pybullet", scene)


def test_pairs_are_sorted_and_every_call_stands_by_itself():
    scene = random_scene("hull", 40, 3.0)
    backend = load("fcl", scene)
    first = backend.pairs(scene.bodies.positions, scene.bodies.quaternions)
    apart = backend.pairs(scene.bodies.positions * 100.0, scene.bodies.quaternions)
    again = backend.pairs(scene.bodies.positions, scene.bodies.quaternions)
    assert len(first) > 10
    assert (first[:, 0] < first[:, 1]).all()
    assert first.tolist() == sorted(first.tolist()) == again.tolist()
    assert apart.shape == (0, 2)


def test_brute_force_puts_every_pair_to_fcl():
    scene = random_scene("mesh", 20, 10.0)
    backend = load("fcl", scene)
    for _ in range(3):
        backend.pairs(scene.bodies.positions, scene.bodies.quaternions)
    assert backend.counters == {"pair_tests": 3 * 190, "narrow_tests": 3 * 190}


def test_a_mesh_inside_another_touches_it_only_at_the_surface():
    bodies = make_bodies([[0, 0, 0], [0.01, 0, 0]], sizes=[1.0, 0.2])
    assert touching("fcl", Scene("mesh", (cube_mesh(),), bodies, Box(np.full(3, 5.0)))) == []
    assert touching("fcl", Scene("hull", (cube_mesh(),), bodies, Box(np.full(3, 5.0)))) == [[0, 1]]


def test_sizes_scale_the_shape():
    for gap, hits in ((1e-9, []), (-1e-9, [[0, 1]])):
        bodies = make_bodies([[0, 0, 0], [2.0 / np.sqrt(3) + gap, 0, 0]], sizes=[1.0, 3.0])
        assert touching("fcl", Scene("mesh", (cube_mesh(),), bodies, Box(np.full(3, 9.0)))) == hits


def test_a_pose_that_is_not_finite_is_refused_before_fcl_sees_it():
    scene = random_scene("mesh", 2, 5.0)
    backend = load("fcl", scene)
    with pytest.raises(ValueError, match="not finite"):
        backend.pairs(np.full((2, 3), np.nan), scene.bodies.quaternions)


def test_a_backend_says_what_it_approximates():
    from harness.backends.protocol import approximations

    assert "hull" in approximations(registry.create("pybullet"))["mesh"]
    assert approximations(registry.create("fcl")) == {}


def test_small_hulls_among_large_ones_are_judged_to_rounding():
    """In units of the median size FCL would take gaps of 1e-2 of these sizes for overlaps."""
    width, small = 1 / np.sqrt(3), 5e-4
    for gap, hits in ((1e-9, []), (-1e-9, [[0, 1]])):
        positions = [[0, 0, 0], [small * (width + gap), small * 0.01, 0], *([3.0 + 2 * k, 5, 5] for k in range(5))]
        bodies = make_bodies(positions, sizes=[small, small, 1, 1, 1, 1, 1])
        assert touching("fcl", Scene("hull", (cube_mesh(),), bodies, Box(np.full(3, 40.0)))) == hits


@pytest.mark.slow
def test_hulls_with_tiny_edges_are_judged_to_the_declared_tolerance():
    mesh = mesh_named("package:pybullet_data/lego/lego_vhacd.obj")
    (pose_set,) = list(hard_poses("hull", (mesh,)))[:1]
    backend = load("fcl", pose_set.scene)
    wrong = []
    for pose in pose_set.poses(pose_set.scene):
        hit = len(backend.pairs(pose.positions, pose.quaternions)) > 0
        truth = judge(pose_set.scene, 0, 1, pose.positions, pose.quaternions)
        if hit != truth.touching:
            wrong.append(abs(truth.gap))
    assert max(wrong, default=0.0) < backend.tolerance("hull")


def test_a_face_without_area_changes_no_verdict_of_fcl():
    mesh = cube_mesh()
    a, b = mesh.faces[0, :2]
    with_thin = dataclasses.replace(mesh, faces=np.vstack([mesh.faces, [[a, b, a]]]).astype(np.int32))
    width = 1 / np.sqrt(3)
    for gap, hits in ((1e-7, []), (1e-9, []), (1e-12, []), (-1e-12, [[0, 1]])):
        bodies = make_bodies([[0, 0, 0], [width + gap, 0.01, 0.02]])
        for one in (mesh, with_thin):
            assert touching("fcl", Scene("mesh", (one,), bodies, Box(np.full(3, 4.0)))) == hits


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ([[0, 2], [0, 1]], "not sorted"),
        ([[0, 1], [0, 1]], "there twice"),
        ([[1, 1]], "i < j"),
        ([[0, 3]], "no such pair of 3 bodies"),
        ([[-1, 1]], "no such pair of 3 bodies"),
        ([[0.0, 1.0]], "float64"),
        ([0, 1], r"shape \(2,\)"),
    ],
)
def test_an_answer_that_breaks_the_contract_ends_a_run_with_the_backend_named(answer, told):
    class Broken:
        name, shapes = "broken", ("sphere",)

        def tolerance(self, shape):
            return 0.0

        def load(self, scene):
            pass

        def pairs(self, positions, quaternions):
            return np.array(answer)

    scene = random_scene("sphere", 3, 4.0)
    law = MotionLaw(0.1, 0.1, "reflect")
    method = method_of(MethodName("pybullet", "native", "sphere"))
    method.backend = Broken
    with pytest.raises(ContractError, match=told) as error:
        method.load(scene, method.plan(scene, law)).fly(law)
    assert 'backend "broken"' in str(error.value)


def test_a_backend_cannot_write_to_the_poses_of_a_run():
    class Writes:
        name, shapes = "writes", ("sphere",)

        def tolerance(self, shape):
            return 0.0

        def load(self, scene):
            pass

        def pairs(self, positions, quaternions):
            positions[:] = 0.0

    scene = random_scene("sphere", 3, 4.0)
    law = MotionLaw(0.1, 0.1, "reflect")
    method = method_of(MethodName("pybullet", "native", "sphere"))
    method.backend = Writes
    with pytest.raises(ValueError, match="read-only"):
        method.load(scene, method.plan(scene, law)).fly(law)
