"""What the kernels settle against FCL on every pair: dense, deep, barely touching, interlocked, tiny and huge."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.methods.narrow_phase import overhang
from harness.motion.kinematics import Trajectory
from harness.narrowphase.gjk import MARGIN
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies
from tests.methods.flights import detector, frames_of, method_for
from tests.narrowphase.meshes import MESHES, crowd, mesh_named, turns


def pairs(scene, algorithm="grid"):
    return detector(scene, algorithm).pairs(scene.bodies.positions, scene.bodies.quaternions).tolist()


def assert_as_brute_force(scene):
    assert pairs(scene) == pairs(scene, "brute-force")


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MESHES, "icosphere-1280.ply", "cube.ply"])
@pytest.mark.parametrize("shape", ["hull", "mesh"])
@settings(max_examples=5)
@given(st.integers(0, 10**6), st.sampled_from([0.6, 1.5, 2.5]), st.sampled_from([1e-6, 1.0, 1e6]))
def test_in_a_crowd_the_pairs_are_those_of_brute_force(name, shape, seed, side, size):
    mesh = mesh_named(name)
    scene = crowd(mesh, shape, 16, side, seed)
    bodies = make_bodies(scene.bodies.positions * size, sizes=np.full(16, size), quaternions=scene.bodies.quaternions)
    assert_as_brute_force(Scene(shape, (mesh,), bodies, Box(np.full(3, side * size))))


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MESHES, "icosphere-1280.ply", "cube.ply"])
@pytest.mark.parametrize("shape", ["hull", "mesh"])
@settings(max_examples=5)
@given(st.integers(0, 10**6), st.sampled_from([1.5, 10.0, 1000.0]), st.sampled_from([0.5, 2.0]))
def test_in_a_crowd_of_mixed_sizes_the_pairs_are_those_of_brute_force(name, shape, seed, ratio, side):
    sizes = ratio ** -np.random.default_rng(seed).choice([0.0, 0.3, 0.5, 1.0], 16)
    assert_as_brute_force(crowd(mesh_named(name), shape, 16, side, seed, sizes))


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MESHES, "cube.ply"])
@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_a_gap_or_an_overlap_of_1e_9_decides(name, shape):
    mesh, rng = mesh_named(name), np.random.default_rng(5)
    for _ in range(8):
        quaternions, along = turns(rng, 2), turns(rng, 1)[0, :3]
        along /= np.linalg.norm(along)

        def two_at(gap, quaternions=quaternions, along=along):
            bodies = make_bodies([[0, 0, 0], along * gap], quaternions=quaternions)
            return Scene(shape, (mesh,), bodies, Box(np.full(3, 2.0)))

        # the outermost contact along the line, as far as FCL tells it
        brute = detector(two_at(1.0), "brute-force")
        touching, apart = 0.0, 1.01
        for step in np.linspace(1.01, 0.0, 60):
            scene = two_at(step)
            if len(brute.pairs(scene.bodies.positions, scene.bodies.quaternions)):
                touching = step
                break
            apart = step
        while apart - touching > 1e-13:
            middle = (apart + touching) / 2
            scene = two_at(middle)
            if len(brute.pairs(scene.bodies.positions, scene.bodies.quaternions)):
                touching = middle
            else:
                apart = middle
        assert pairs(two_at(touching - 1e-9)) == pairs(two_at(touching - 1e-9), "brute-force") == [[0, 1]]
        assert pairs(two_at(touching + 1e-9)) == pairs(two_at(touching + 1e-9), "brute-force") == []


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
def test_meshes_that_reach_into_each_others_hulls_are_told_apart(name):
    """Interlocked: the hulls overlap and the surfaces do not."""
    mesh, found = mesh_named(name), 0
    for seed in range(12):
        scene = crowd(mesh, "mesh", 24, 2.2, seed)
        hulls = pairs(Scene("hull", (mesh,), scene.bodies, scene.box))
        meshes = pairs(scene)
        assert meshes == pairs(scene, "brute-force")
        found += len(hulls) - len(meshes)
    assert found > 0 or name.endswith("soccerball.obj")


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MESHES, "cube.ply"])
@pytest.mark.parametrize("shape", ["hull", "mesh"])
@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_what_is_remembered_from_frame_to_frame_changes_no_answer(name, shape, ratio):
    sizes = ratio ** -np.random.default_rng(1).choice([0.0, 0.5, 1.0], 24)
    scene = crowd(mesh_named(name), shape, 24, 2.2, 3, sizes)
    trajectory = Trajectory(scene.bodies, scene.box, folded=True, turning=True)
    kept, brute = detector(scene), detector(scene, "brute-force")
    # frames, then leaps, then the first frame again
    for time in [*np.arange(5) / 60, 5.0, 5.5, 5.5, 0.0]:
        trajectory.move_to(time)
        answer = kept.pairs(trajectory.positions, trajectory.quaternions).tolist()
        fresh = detector(scene)
        assert answer == fresh.pairs(trajectory.positions, trajectory.quaternions).tolist()
        assert answer == brute.pairs(trajectory.positions, trajectory.quaternions).tolist()
        if shape == "mesh":
            assert kept.contained.tolist() == fresh.contained.tolist()


def test_bodies_on_top_of_each_other_touch():
    for shape in ("hull", "mesh"):
        bodies = make_bodies(np.zeros((3, 3)))
        assert pairs(Scene(shape, (cube_mesh(),), bodies, Box(np.ones(3)))) == [[0, 1], [0, 2], [1, 2]]


@pytest.mark.parametrize("name", ["cube.ply", "pumpkin-1753.ply", MESHES[1], MESHES[3]])
def test_a_mesh_inside_another_is_no_hit_and_said_to_be_contained(name):
    mesh, rng = mesh_named(name), np.random.default_rng(0)
    inside = mesh.hull.vertices.mean(axis=0)
    bodies = make_bodies(
        [inside, inside, np.add(inside, [0, 0, 5])],
        sizes=[1e-3, 1.0, 1e-3],
        quaternions=np.concatenate([turns(rng, 1), [[1, 0, 0, 0]] * 2]),
    )
    scene = Scene("mesh", (mesh,), bodies, Box(np.full(3, 10.0)))
    made = detector(scene)
    assert made.pairs(bodies.positions, bodies.quaternions).tolist() == pairs(scene, "brute-force") == []
    assert made.contained.tolist() == [[0, 1]]
    assert made.counters["contained_pairs"] == 1
    assert pairs(Scene("hull", (mesh,), bodies, scene.box)) == [[0, 1]]


def test_a_mesh_in_a_hollow_of_another_is_not_contained():
    mesh = mesh_named(MESHES[1])
    rng = np.random.default_rng(0)
    surface = detector(crowd(mesh, "mesh", 2, 1.0, 0, [1.0, 1e-4]))
    found = set()
    for _ in range(300):
        shares = rng.dirichlet(np.ones(len(mesh.hull.vertices)) * 0.05)
        place = shares @ mesh.hull.vertices
        quaternions = np.array([[1.0, 0, 0, 0], [1.0, 0, 0, 0]])
        if not len(surface.pairs(np.array([[0, 0, 0], place]), quaternions)):
            found.add(len(surface.contained))
    assert found == {0, 1}


def test_most_pairs_are_settled_without_fcl():
    scene = crowd(mesh_named("pumpkin-1753.ply"), "mesh", 100, 4.0, 0)
    made = detector(scene)
    touching = made.pairs(scene.bodies.positions, scene.bodies.quaternions)
    counted = made.counters
    assert len(touching) > 100
    assert counted["hull_tests"] > counted["narrow_tests"] >= len(touching)
    assert counted["fcl_tests"] < 0.1 * counted["narrow_tests"]
    hulls = detector(Scene("hull", (scene.mesh,), scene.bodies, scene.box))
    hulls.pairs(scene.bodies.positions, scene.bodies.quaternions)
    assert hulls.counters["fcl_tests"] == 0


def test_without_the_hull_axis_all_close_pairs_are_put_to_fcl():
    scene = crowd(mesh_named("pumpkin-1753.ply"), "mesh", 30, 2.5, 0)
    method = method_for(scene, "grid", forced={"hull_axis": False})
    made = method.detector(scene, method.plan(scene, frames_of(1, 1.0)))
    answer = made.pairs(scene.bodies.positions, scene.bodies.quaternions)
    assert answer.tolist() == pairs(scene)
    assert made.counters["fcl_tests"] == made.counters["narrow_tests"] > len(answer)


@pytest.mark.parametrize("shape", ["hull", "mesh"])
@pytest.mark.parametrize("spoilt", [np.nan, np.inf, 0.0])
def test_an_orientation_that_is_none_is_refused(shape, spoilt):
    scene = crowd(cube_mesh(), shape, 2, 0.5, 0)
    quaternions = scene.bodies.quaternions.copy()
    quaternions[1] = spoilt
    with pytest.raises(ValueError, match="unit quaternion"):
        detector(scene).pairs(scene.bodies.positions, quaternions)


def test_hulls_hold_their_meshes_to_rounding():
    for name in [*MESHES, "cube.ply", "icosphere-1280.ply"]:
        assert overhang(mesh_named(name)) < MARGIN
