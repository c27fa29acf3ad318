"""Distances of hulls. What certifies them is looked at again here, with every vertex and in plain arithmetic."""

import fcl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.kernel import kernel
from harness.narrowphase.gjk import COLD_START, MARGIN, hull_distance, relative_pose
from harness.narrowphase.support import support_map
from harness.narrowphase.vectors import rotation
from harness.narrowphase.verdicts import PairVerdict
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import MESHES, mesh_named, turns

STRAIGHT = np.array([1.0, 0, 0, 0])


@kernel
def ask(hull, turn_a, size_a, turn_b, size_b, offset, start, enough):
    a = rotation(turn_a[0], turn_a[1], turn_a[2], turn_a[3])
    b = rotation(turn_b[0], turn_b[1], turn_b[2], turn_b[3])
    pose = relative_pose(a, size_a, b, size_b, (offset[0], offset[1], offset[2]))
    axis = (-pose.offset[0], -pose.offset[1], -pose.offset[2])
    return hull_distance(hull, hull, pose, start, axis, MARGIN * (size_a + size_b), enough, 0.0), pose


def distance(mesh, offset, turn_a=STRAIGHT, turn_b=STRAIGHT, sizes=(1.0, 1.0), start=COLD_START, enough=np.inf):
    hull = support_map(mesh.hull.vertices)
    offset = np.array(offset, float)
    return ask(hull, turn_a, float(sizes[0]), turn_b, float(sizes[1]), offset, start, float(enough))


def assert_certified(mesh, found, pose):
    """The points are in their hulls, the axis separates every vertex, and the two bounds agree."""
    at_a = mesh.hull.vertices * pose.size_a
    at_b = mesh.hull.vertices * pose.size_b @ np.array(pose.rotation).T + np.array(pose.offset)
    scale = pose.size_a + pose.size_b
    axis = np.array(found.axis) / np.linalg.norm(found.axis)
    assert (at_a @ axis).min() - (at_b @ axis).max() >= found.lower - 1e-15 * scale
    assert np.linalg.norm(np.subtract(found.point_a, found.point_b)) == pytest.approx(found.upper, abs=2e-15 * scale)
    corners = {pair for pair in found.warm_start if pair >= 0}
    for point, vertices, which in ((found.point_a, at_a, 32), (found.point_b, at_b, 0)):
        carrying = vertices[sorted({pair >> which & 0xFFFFFFFF for pair in corners})]
        shares, *_ = np.linalg.lstsq(np.vstack([carrying.T, np.ones(len(carrying))]), [*point, 1], rcond=None)
        assert np.allclose(shares @ carrying, point, atol=1e-12 * scale)
        assert (shares >= -1e-9).all() or len(carrying) == 3
    assert found.upper - found.lower <= 1e-12 * found.upper + 1e-14 * scale


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
def test_both_bounds_on_the_distance_are_proved_and_agree(name):
    mesh, rng = mesh_named(name), np.random.default_rng(1)
    for _ in range(150):
        sizes = 10.0 ** rng.uniform(-1, 1, 2)
        offset = rng.normal(size=3)
        offset *= sizes.sum() / 2 * rng.uniform(0.7, 3) / np.linalg.norm(offset)
        found, pose = distance(mesh, offset, *turns(rng, 2), sizes=sizes)
        if found.verdict == PairVerdict.SEPARATE:
            assert_certified(mesh, found, pose)


@pytest.mark.parametrize(
    ("offset", "turn", "expected"),
    [
        ((2.0, 0.1, 0.2), STRAIGHT, 2 - 1 / np.sqrt(3)),  # face to face
        ((2.0, 0, 0), np.array([np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)]), 2 - (1 + np.sqrt(2)) / np.sqrt(12)),
        ((1.5, 1.5, 1.5), STRAIGHT, 1.5 * np.sqrt(3) - 1),  # corner to corner
        ((0.0, 2.0, 2.0), STRAIGHT, 2 * np.sqrt(2) - np.sqrt(2 / 3)),  # edge to edge
        ((1 / np.sqrt(3) + 1e-9, 0, 0), STRAIGHT, 1e-9),
    ],
)
def test_distances_of_cubes_are_those_of_the_drawing_board(offset, turn, expected):
    for start in (COLD_START, distance(cube_mesh(), [3, 0, 0.1])[0].warm_start):
        found, _ = distance(cube_mesh(), offset, turn_b=turn, start=start)
        assert found.verdict == PairVerdict.SEPARATE
        assert found.lower == pytest.approx(expected, rel=1e-12, abs=4e-16)
        assert found.upper == pytest.approx(expected, rel=1e-12, abs=4e-16)


def test_cubes_that_just_touch_are_left_undecided_and_a_hair_decides():
    width = 1 / np.sqrt(3)
    assert distance(cube_mesh(), [width, 0.1, 0.02])[0].verdict == PairVerdict.UNDECIDED
    assert distance(cube_mesh(), [width + 1e-12, 0.1, 0.02])[0].verdict == PairVerdict.SEPARATE
    assert distance(cube_mesh(), [width - 1e-12, 0.1, 0.02])[0].verdict == PairVerdict.TOUCHING


def test_concentric_hulls_are_no_trap():
    for turn in (STRAIGHT, turns(np.random.default_rng(0), 1)[0]):
        for sizes in ((1.0, 1.0), (1.0, 0.01)):
            found, _ = distance(cube_mesh(), [0, 0, 0], turn_b=turn, sizes=sizes)
            assert found.verdict != PairVerdict.SEPARATE


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_a_gap_or_overlap_of_1e_9_of_the_size_is_told(name, size):
    mesh, rng = mesh_named(name), np.random.default_rng(2)
    for _ in range(40):
        turned, offset = turns(rng, 2), rng.normal(size=3)
        offset *= 1.2 * size / np.linalg.norm(offset)
        apart, _ = distance(mesh, offset, *turned, sizes=(size, size))
        axis = np.array(apart.axis) / np.linalg.norm(apart.axis)
        w, x, y, z = turned[0]
        axis = np.array(rotation(w, x, y, z)) @ axis
        for gap, verdict in ((1e-9, PairVerdict.SEPARATE), (-1e-9, PairVerdict.TOUCHING)):
            near = offset + axis * (apart.upper - gap * size)
            assert distance(mesh, near, *turned, sizes=(size, size))[0].verdict == verdict


@pytest.mark.slow
@settings(max_examples=50)
@given(st.integers(0, 10**6), st.sampled_from(MESHES), st.sampled_from([0.5, 1.0, 2.0]))
def test_a_warm_start_changes_no_answer(seed, name, far):
    mesh, rng = mesh_named(name), np.random.default_rng(seed)
    vertices = len(mesh.hull.vertices)
    turned, offset = turns(rng, 2), rng.normal(size=3)
    offset *= far / np.linalg.norm(offset)
    cold, _ = distance(mesh, offset, *turned)
    before, _ = distance(mesh, offset + rng.normal(size=3) * 0.05, *turned)
    any_corners = rng.integers(0, vertices, (4, 2)).tolist()
    anything = tuple(a << 32 | b for a, b in any_corners)
    for start in (before.warm_start, cold.warm_start, anything, (*anything[:2], -1, -1)):
        warm, _ = distance(mesh, offset, *turned, start=start)
        assert warm.verdict == cold.verdict
        assert warm.upper == pytest.approx(cold.upper, rel=1e-12, abs=1e-14)


def test_a_search_for_a_touch_may_stop_at_the_first_separating_axis():
    found, _ = distance(cube_mesh(), [1.2, 0.7, 0.3], enough=2e-13)
    exact, _ = distance(cube_mesh(), [1.2, 0.7, 0.3])
    assert found.verdict == PairVerdict.SEPARATE
    assert 0 < found.lower <= exact.lower <= exact.upper <= found.upper


def test_fcl_measures_the_same_distances():
    mesh, rng = cube_mesh(), np.random.default_rng(3)
    faces = np.hstack([np.full((12, 1), 3), mesh.hull.faces]).astype(np.int64).ravel()
    cubes = [fcl.CollisionObject(fcl.Convex(mesh.hull.vertices, 12, faces)) for _ in range(2)]
    for _ in range(200):
        turned, offset = turns(rng, 2), rng.normal(size=3)
        offset *= rng.uniform(1.01, 2) / np.linalg.norm(offset)
        for cube, turn, place in zip(cubes, turned, (np.zeros(3), offset), strict=True):
            cube.setQuatRotation(turn)
            cube.setTranslation(place)
        theirs = fcl.distance(*cubes, fcl.DistanceRequest(), fcl.DistanceResult())
        assert distance(mesh, offset, *turned)[0].upper == pytest.approx(theirs, rel=1e-6)
