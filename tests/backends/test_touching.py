"""Each backend against closed forms, and against each other."""

import numpy as np
import pytest

from harness.backends import registry
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, random_scene


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
    scene = Scene(shape, cube_mesh(), make_bodies(positions, sizes=[size, size]), Box(np.full(3, 100.0 * size)))
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
    assert touching("fcl", Scene("mesh", cube_mesh(), bodies, Box(np.full(3, 5.0)))) == []
    assert touching("fcl", Scene("hull", cube_mesh(), bodies, Box(np.full(3, 5.0)))) == [[0, 1]]


def test_sizes_scale_the_shape():
    for gap, hits in ((1e-9, []), (-1e-9, [[0, 1]])):
        bodies = make_bodies([[0, 0, 0], [2.0 / np.sqrt(3) + gap, 0, 0]], sizes=[1.0, 3.0])
        assert touching("fcl", Scene("mesh", cube_mesh(), bodies, Box(np.full(3, 9.0)))) == hits


def test_a_pose_that_is_not_finite_is_refused_before_fcl_sees_it():
    scene = random_scene("mesh", 2, 5.0)
    backend = load("fcl", scene)
    with pytest.raises(ValueError, match="not finite"):
        backend.pairs(np.full((2, 3), np.nan), scene.bodies.quaternions)


def test_a_backend_says_what_it_approximates():
    from harness.backends.protocol import approximations

    assert "hull" in approximations(registry.create("pybullet"))["mesh"]
    assert approximations(registry.create("fcl")) == {}
