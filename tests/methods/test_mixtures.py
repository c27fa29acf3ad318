"""Scenes of several meshes: every method finds what brute force finds, and the exact judge agrees."""

import json

import numpy as np
import pytest

from harness.backends.statement import missing
from harness.compare.judge import touches
from harness.methods.registry import method_of
from harness.motion.law import MotionLaw
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.launch import directions, orientations
from harness.scene.scene import Scene
from harness.vocabulary import MethodName
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import mesh_named

pytest.importorskip("pybullet_data", reason="pip install 'harness[pybullet]'")
MESHES = (
    cube_mesh(),
    mesh_named("pumpkin-1753.ply"),
    mesh_named("package:pybullet_data/duck.obj"),
    mesh_named("package:pybullet_data/teddy2_VHACD_CHs.obj"),
    mesh_named("package:pybullet_data/bunny.obj"),
)
PEERS = tuple(name for name in ("coal", "trimesh", "pybullet", "mujoco") if missing(name) is None)
EXACT = ("fcl/grid", "fcl/sap", "fcl/tree", *(name for name in ("coal", "trimesh") if name in PEERS))


def mixture(shape, seed, count=24, **more):
    """Random bodies of 3 to 5 meshes that overlap each other, some in one size and some in many."""
    rng = np.random.default_rng(seed)
    meshes = MESHES[: int(rng.integers(3, 6))]
    sizes = np.ones(count) if seed % 2 else rng.uniform(0.4, 1.5, count)
    spins = directions(rng, count) * rng.uniform(0, 3, (count, 1))
    positions = rng.uniform(-1, 1, (count, 3))
    bodies = Bodies(positions, directions(rng, count), orientations(rng, count), spins, sizes, sizes**3)
    mesh_of = rng.integers(len(meshes), size=count)
    return Scene(shape, meshes, bodies, Box(np.full(3, 1.8)), mesh_of=mesh_of, **more)


def detected(name, scene):
    method = method_of(MethodName.read(name, scene.shape))
    detector = method.detector(scene, method.detection(scene))
    return detector.pairs(scene.bodies.positions, scene.bodies.quaternions).tolist()


def judged(scene, found):
    """A pair that touches and one that does not, of the fewest faces: exact arithmetic on large surfaces takes long."""
    count = len(scene.mesh_of)
    faces = np.array([len(mesh.faces) for mesh in scene.meshes])[scene.mesh_of]
    unlike = [(i, j) for i in range(count) for j in range(i + 1, count) if scene.mesh_of[i] != scene.mesh_of[j]]
    unlike.sort(key=lambda pair: faces[list(pair)].sum())
    touching = [pair for pair in unlike if pair in found]
    return [touching[0], next(pair for pair in unlike if pair not in found)]


@pytest.mark.parametrize("shape", ["hull", pytest.param("mesh", marks=pytest.mark.slow)])
def test_all_methods_find_the_same_pairs_of_several_meshes_and_the_judge_agrees(shape):
    for seed in range(4):
        scene = mixture(shape, seed)
        expected = detected("fcl", scene)
        assert 5 < len(expected) < 24 * 23 / 2
        for name in EXACT:
            assert detected(name, scene) == expected, (name, seed)
        found = {tuple(pair) for pair in expected}
        positions, quaternions = scene.bodies.positions, scene.bodies.quaternions
        for i, j in judged(scene, found):
            assert touches(scene, i, j, positions, quaternions) == ((i, j) in found)


@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_a_flight_of_several_meshes_is_the_same_by_every_method(shape):
    scene, law = mixture(shape, 5, count=10), MotionLaw(1.5, 0.05, "reflect")
    digests = {}
    for name in ("fcl", "fcl/grid", "fcl/sap", "fcl/tree"):
        method = method_of(MethodName.read(name, shape))
        outcome = method.load(scene, method.plan(scene, law)).fly(law, traced=True)
        json.dumps(outcome.trace.to_json(), allow_nan=False)  # as `harness trace --json` prints it
        digests[name] = (outcome.metrics["event_digest"], outcome.metrics["box_hits"])
    assert len(set(digests.values())) == 1
    assert digests["fcl"][1] > 0


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_hits_of_several_meshes_are_predicted_where_frames_see_them(shape):
    scene, law = mixture(shape, 6, count=14), MotionLaw(1.2, 2e-3, "none")
    onsets = {}
    for name in ("fcl/grid", "fcl/predictive"):
        method = method_of(MethodName.read(name, shape))
        trace = method.load(scene, method.plan(scene, law)).fly(law, traced=True).trace
        pairs = trace.walls < 0
        rows = zip(trace.times[pairs].tolist(), map(tuple, trace.bodies[pairs].tolist()), strict=True)
        onsets[name] = [(time, pair) for time, pair in rows if time > 4e-3]
    assert len(onsets["fcl/grid"]) > 3
    for time, pair in onsets["fcl/grid"]:
        assert any(other == pair and time - 2.2e-3 <= at <= time for at, other in onsets["fcl/predictive"])


@pytest.mark.parametrize("shape", ["sphere", "hull", pytest.param("mesh", marks=pytest.mark.slow)])
def test_an_ignored_pair_is_found_by_no_method_and_all_others_are(shape):
    scene = mixture(shape, 1)
    expected = detected("fcl", scene)
    ignored = np.array(sorted(expected[::3]))
    less = mixture(shape, 1, ignored=ignored)
    for name in ("fcl", "fcl/grid", "fcl/sap", "fcl/tree", *PEERS):
        if name == "trimesh" and shape == "sphere":
            continue
        all_pairs = detected(name, scene)
        assert detected(name, less) == [pair for pair in all_pairs if pair not in ignored.tolist()], name


def test_brute_force_counts_no_ignored_pair():
    scene, law = mixture("mesh", 1, ignored=np.array([[0, 1], [2, 5]])), MotionLaw(0.2, 0.1, "reflect")
    method = method_of(MethodName.read("fcl", "mesh"))
    metrics = method.load(scene, method.plan(scene, law)).fly(law).metrics
    assert metrics["pair_tests"] == 2 * (24 * 23 // 2 - 2)
