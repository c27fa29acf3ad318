"""Whatever the algorithm, FCL's answer is that of every pair put to it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, random_scene
from tests.methods.flights import detector


def answers(scene, algorithm):
    asked = detector(scene, algorithm)
    return asked.pairs(scene.bodies.positions, scene.bodies.quaternions).tolist(), asked.counters


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ["grid", "tree"])
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@settings(max_examples=30)
@given(st.integers(0, 10**6), st.sampled_from([2.0, 4.0, 8.0]), st.sampled_from([1.0, 3.0, 100.0]))
def test_the_pairs_are_those_of_brute_force(algorithm, shape, seed, side, ratio):
    scene = random_scene(shape, 30, side, seed)
    sizes = ratio ** -np.random.default_rng(seed).uniform(size=30)
    bodies = make_bodies(scene.bodies.positions, sizes=sizes, quaternions=scene.bodies.quaternions)
    scene = Scene(shape, (cube_mesh(),), bodies, scene.box)
    assert answers(scene, algorithm)[0] == answers(scene, "brute-force")[0]


@pytest.mark.parametrize("algorithm", ["grid", "tree"])
@pytest.mark.parametrize("unit", [1.0, 0.1, 1 / 3])
def test_spheres_on_a_lattice_that_just_touch_are_judged_to_the_bit(algorithm, unit):
    lattice = np.array([[x, y, z] for x in range(4) for y in range(4) for z in range(4)]) * unit
    scene = Scene("sphere", (), make_bodies(lattice, sizes=np.full(64, unit)), Box(np.full(3, 4 * unit)))
    assert answers(scene, algorithm)[0] == answers(scene, "brute-force")[0]


@pytest.mark.parametrize("algorithm", ["grid", "tree"])
def test_only_close_pairs_are_put_to_the_exact_shape(algorithm):
    scene = random_scene("mesh", 200, 12.0)
    found, counters = answers(scene, algorithm)
    gaps = np.linalg.norm(scene.bodies.positions[:, None] - scene.bodies.positions, axis=2)
    assert counters["narrow_tests"] == np.count_nonzero(np.triu(gaps <= 1.0, 1))
    assert len(found) < counters["narrow_tests"] <= counters["pair_tests"] < 200 * 199 // 4
