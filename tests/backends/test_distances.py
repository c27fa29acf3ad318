"""How far apart bodies are, asked of every library that answers it, against exact rationals and closed forms."""

import dataclasses
import functools
import itertools

import numpy as np
import pytest

from harness.backends import registry
from harness.backends.contract import require_gaps
from harness.backends.protocol import Near, own_hulls, queries, set_accuracy
from harness.compare.exact import PlacedPoints
from harness.compare.exact_distance import hull_distance, surface_distance
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, random_scene, slow_beyond

# Of a size: by how much gaps of hulls and meshes may be off; those of pybullet and mujoco against their own hulls.
ERRORS = {
    "fcl": 1e-14,
    "trimesh": 1e-14,
    "coal": 1e-12,
    "drake": 1e-14,
    "mujoco": 1e-6,
    "pybullet": 3e-4,
    "rapier3d": 2e-3,
}
SINGLE = {"rapier3d"}
GAPLESS = {("rapier3d", "mesh")}
WITHIN = 0.4


@pytest.fixture(params=ERRORS)
def backend(request):
    if request.param != "fcl":
        pytest.importorskip({"drake": "pydrake"}.get(request.param, request.param))
    return registry.create(request.param)


def near_pairs(backend, scene, within=WITHIN):
    backend.load(scene)
    poses = scene.bodies.positions, scene.bodies.quaternions
    found = require_gaps(backend.name, backend.distances(*poses, within), len(scene.bodies), within)
    if isinstance(backend, Near):
        assert backend.near(*poses, within).tolist() == found.pairs.tolist()
    return found


def asked_about(backend, scene):
    """The scene with the shape and the hulls that a loaded backend really holds."""
    held = {} if scene.shape == "sphere" else own_hulls(backend)
    return dataclasses.replace(scene, shape="hull", hulls=held) if held else scene


def true_gap(scene, i, j):
    bodies = scene.bodies
    if scene.shape == "sphere":
        between = np.linalg.norm(bodies.positions[i] - bodies.positions[j])
        return max(0.0, between - (bodies.sizes[i] + bodies.sizes[j]) / 2)
    solids = [scene.solid_of(bodies.sizes[k]) for k in (i, j)]
    one, other = (
        PlacedPoints(solid.vertices, bodies.positions[k], bodies.quaternions[k])
        for k, solid in zip((i, j), solids, strict=True)
    )
    if scene.shape == "hull":
        return hull_distance(one, other).gap
    return surface_distance(one, solids[0].faces, other, solids[1].faces).gap


@functools.cache
def some_scene(shape, size):
    """Bodies of two sizes in close packing."""
    scene = random_scene(shape, 10, 2.7, seed=5)
    bodies = dataclasses.replace(
        scene.bodies, positions=scene.bodies.positions * size, sizes=np.where(np.arange(10) % 3, 1.0, 0.5) * size
    )
    return dataclasses.replace(scene, bodies=bodies, box=Box(np.full(3, 9 * size)))


def true_gaps(scene):
    return {pair: true_gap(scene, *pair) for pair in itertools.combinations(range(len(scene.bodies)), 2)}


@functools.cache
def truth_of(shape, size):
    return true_gaps(some_scene(shape, size))


@pytest.mark.parametrize("shape", slow_beyond(["sphere", "hull", "mesh"], 2))
@pytest.mark.parametrize("size", [pytest.param(1e-3, marks=pytest.mark.slow), 1.0])
def test_gaps_are_those_of_exact_arithmetic(backend, shape, size):
    if shape not in backend.shapes or (backend.name, shape) in GAPLESS:
        pytest.skip("it has no gaps of such a shape")
    scene = some_scene(shape, size)
    found = near_pairs(backend, scene, WITHIN * size)
    error = ERRORS[backend.name] if shape != "sphere" else 1e-6 if backend.name in SINGLE else 1e-15
    real = asked_about(backend, scene)
    truth = truth_of(shape, size) if real is scene else true_gaps(real)
    gaps = dict(zip(map(tuple, found.pairs.tolist()), found.gaps, strict=True))
    assert set(gaps) == {pair for pair, gap in truth.items() if gap <= WITHIN * size}
    assert sum(gap == 0.0 for gap in gaps.values()) > 5
    assert sum(gap > 0.0 for gap in gaps.values()) > 10
    assert max(abs(gaps[pair] - truth[pair]) for pair in gaps) <= error * size
    # points of touching pairs mean nothing
    apart = found.gaps > 0.0
    between = np.linalg.norm(found.points[apart, 0] - found.points[apart, 1], axis=1)
    np.testing.assert_allclose(between, found.gaps[apart], rtol=0, atol=max(1e-14, error) * size)
    for k in range(2):  # each point is of its own body: no farther from its centre than the body reaches
        owners = found.pairs[apart, k]
        off = np.linalg.norm(found.points[apart, k] - scene.bodies.positions[owners], axis=1)
        assert (off <= scene.bodies.sizes[owners] / 2 + 2 * error * size).all()


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_first_contact_and_the_distance_asked_for_decide(backend, shape):
    if shape not in backend.shapes or (backend.name, shape) in GAPLESS:
        pytest.skip("it has no gaps of such a shape")
    width = 1.0 if shape == "sphere" else 1 / np.sqrt(3)
    band = max(4e-15, 2 * backend.tolerance(shape))
    expected = {
        -band: True, band: True, 0.25 - band: True, 0.25 + band: False, 1e3: False,
    }  # fmt: skip
    for gap, is_near in expected.items():
        bodies = make_bodies([[0, 0, 0], [width + gap, 0, 0]])
        found = near_pairs(backend, Scene(shape, (cube_mesh(),), bodies, Box(np.full(3, 2e3))), 0.25)
        assert len(found.pairs) == is_near
        if is_near:
            assert abs(found.gaps[0] - max(gap, 0.0)) <= max(1e-15, band)


def test_a_body_inside_another_is_at_no_gap_as_a_solid_and_at_that_of_the_surfaces_as_a_mesh(backend):
    bodies = make_bodies([[0, 0, 0], [0.01, 0, 0]], sizes=[1.0, 0.2])
    for shape in ("hull", "mesh"):
        if shape not in backend.shapes or (backend.name, shape) in GAPLESS:
            continue
        found = near_pairs(backend, Scene(shape, (cube_mesh(),), bodies, Box(np.full(3, 5.0))), 1.0)
        solid = shape == "hull" or "mesh" in getattr(backend, "solid", ()) or own_hulls(backend)
        gap = 0.0 if solid else (1.0 - 0.2) / np.sqrt(12) - 0.01
        assert found.gaps.tolist() == pytest.approx([gap], abs=1e-12)


def test_nothing_is_near_where_nothing_is(backend):
    scene = random_scene("hull", 5, 3.0)
    found = near_pairs(backend, dataclasses.replace(scene, bodies=make_bodies(np.eye(3) * 50.0)))
    assert (found.pairs.shape, found.gaps.shape) == ((0, 2), (0,))
    with pytest.raises(ValueError, match="not finite"):
        backend.distances(np.full((3, 3), np.nan), scene.bodies.quaternions[:3], 1.0)


def test_an_answer_depends_on_the_poses_alone(backend):
    scene = random_scene("hull", 20, 3.0, seed=2)
    backend.load(scene)
    poses, elsewhere = (scene.bodies.positions, scene.bodies.quaternions), scene.bodies.positions[::-1].copy()
    first = backend.distances(*poses, WITHIN)
    backend.distances(elsewhere, poses[1], WITHIN)
    backend.pairs(elsewhere, poses[1])
    backend.distances(*poses, 2 * WITHIN)
    again = backend.distances(*poses, WITHIN)
    assert first.pairs.tolist() == again.pairs.tolist()
    np.testing.assert_allclose(again.gaps, first.gaps, rtol=0, atol=1e-15)  # a library may swap the two bodies
    touching = first.pairs[first.gaps == 0.0].tolist()
    assert backend.pairs(*poses).tolist() == touching


def test_a_backend_says_that_it_can_be_asked(backend):
    assert {"collision", "tolerance", "distance"} <= set(queries(backend))


def test_coal_is_as_exact_as_it_is_asked_to_be():
    pytest.importorskip("coal")
    errors = []
    for accuracy in (1e-2, 1e-9):
        backend, scene = registry.create("coal"), random_scene("hull", 40, 4.0, seed=5)
        assert set_accuracy(backend, accuracy)
        found = near_pairs(backend, scene)
        exact = [true_gap(scene, *pair) for pair in found.pairs.tolist()]
        errors.append(np.abs(found.gaps - exact).max())
    assert errors[1] < 1e-12
    assert errors[0] < 4e-2


@pytest.mark.slow
def test_mujoco_makes_room_for_as_many_contacts_as_there_are():
    pytest.importorskip("mujoco")
    backend, scene = registry.create("mujoco"), random_scene("sphere", 450, 12.0)
    assert len(near_pairs(backend, scene, 20.0).pairs) == 450 * 449 // 2
