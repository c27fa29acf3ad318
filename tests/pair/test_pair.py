"""What Python is told of two bodies, against closed forms and the exact judge; and what it is told of nonsense."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import harness
from harness.errors import InputError
from harness.scene.mesh_file import make_mesh
from tests.narrowphase.meshes import turns
from tests.pair.judged_gaps import FAR, FORMS, GAPS, OF_SIZE, RATIOS, Case, judge_many, judged


def test_gaps_and_touching_of_random_and_degenerate_pairs_are_those_of_the_exact_judge():
    most, wrong = judge_many(12)
    assert wrong == []
    assert most <= OF_SIZE


@pytest.mark.slow
@settings(max_examples=150)
@given(
    st.integers(0, 10**6),
    st.sampled_from(["hull", "mesh"]),
    st.tuples(st.sampled_from(FORMS), st.sampled_from(FORMS)),
    st.sampled_from(GAPS),
    st.sampled_from(RATIOS),
    st.sampled_from(FAR),
)
def test_gap_nearest_points_and_touching_are_those_of_the_exact_judge(seed, shape, forms, gap, ratio, far):
    assert judged(Case(shape, forms, gap, ratio, far), np.random.default_rng(seed)).wrong == ""


@pytest.mark.parametrize("lift", [1e-9, *(pytest.param(lift, marks=pytest.mark.slow) for lift in (1e-3, 0.4))])
def test_a_small_surface_is_as_far_from_a_wide_floor_as_its_lowest_vertex(lift):
    floor, ball = trimesh.creation.box((10.0, 10.0, 1.0)), trimesh.creation.icosphere(3)
    size, rng = float(np.sqrt(201.0)), np.random.default_rng(7)
    unit = ball.vertices / 2.0  # of diameter 1
    for quaternion in turns(rng, 5):
        w, axis = quaternion[0], quaternion[1:]
        turned = unit + 2.0 * np.cross(axis, np.cross(axis, unit) + w * unit)
        place = np.array([*rng.uniform(-4.0, 4.0, 2), 0.5 + lift - 0.3 * turned[:, 2].min()])
        for one, other in (("floor", "ball"), ("ball", "floor")):
            bodies = {
                "floor": harness.Body(floor, size=size),
                "ball": harness.Body(ball, place, quaternion, size=0.3),
            }
            found = harness.distance(bodies[one], bodies[other])
            assert found.gap == pytest.approx(lift, abs=1e-13)
            assert float(np.linalg.norm(found.points[0] - found.points[1])) == pytest.approx(lift, abs=1e-13)


@pytest.mark.parametrize("gap", [1e-12, 1e-6, 0.1, 1e8])
@pytest.mark.parametrize("size", [1.0, 1000.0])
def test_spheres_are_as_far_apart_as_their_centres_less_their_radii(gap, size):
    one, other = (
        harness.Body(None, (x, 0, 0), size=s, shape="sphere") for x, s in ((0, 1), (gap + 0.5 + size / 2, size))
    )
    found = harness.distance(one, other)
    assert found.gap == pytest.approx(gap, rel=1e-15, abs=1e-12)
    assert found.points[0].tolist() == [0.5, 0, 0]
    assert not harness.touching(one, other)


def test_a_point_in_both_is_told_of_spheres_that_overlap():
    one, other = harness.Body(None, size=4, shape="sphere"), harness.Body(None, (1, 0, 0), size=1, shape="sphere")
    found = harness.distance(one, other)
    assert found.gap == 0.0
    assert found.points.tolist() == [[1, 0, 0], [1, 0, 0]]


def test_arrays_of_poses_give_the_answers_of_each_pose():
    rng = np.random.default_rng(3)
    positions, quaternions = rng.normal(size=(20, 3)), turns(rng, 20)
    for shape in ("sphere", "hull", "mesh"):
        one = harness.Body("cube.ply", shape=shape)
        many = harness.Body("cube.ply", positions, quaternions, velocity=-positions, spin=(0, 0, 2), shape=shape)
        each = [
            harness.Body("cube.ply", x, q, velocity=-x, spin=(0, 0, 2), shape=shape)
            for x, q in zip(positions, quaternions, strict=True)
        ]
        gaps, points = harness.distance(one, many)
        assert gaps.tolist() == [harness.distance(one, body).gap for body in each]
        assert points.tolist() == [harness.distance(one, body).points.tolist() for body in each]
        assert harness.touching(one, many).tolist() == [harness.touching(one, body) for body in each]
        assert harness.touching(one, many).tolist() == (gaps == 0).tolist()
        times = harness.time_of_impact(one, many, until=2.0)
        assert times.tolist() == [harness.time_of_impact(one, body, 2.0) for body in each]
        assert (times[gaps == 0] == 0).all()


def test_no_poses_give_no_answers():
    none = harness.Body("cube.ply", position=np.empty((0, 3)))
    gaps, points = harness.distance(none, harness.Body("cube.ply"))
    assert gaps.shape == (0,)
    assert points.shape == (0, 2, 3)


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_the_time_of_impact_is_that_of_the_closed_form_from_near_and_from_far(shape):
    width = 1.0 if shape == "sphere" else 1 / np.sqrt(3)
    for way in (2.0, 1e8):
        target = harness.Body("cube.ply", shape=shape)
        shot = harness.Body("cube.ply", (way, 0, 0), velocity=(-1, 0, 0), shape=shape)
        assert harness.time_of_impact(target, shot, np.inf) == pytest.approx(way - width, rel=1e-15, abs=2e-9)
        assert harness.time_of_impact(target, shot, way - width - 1e-3) == np.inf


def test_a_mesh_in_arrays_is_the_same_as_in_a_file():
    cube = trimesh.creation.box()
    assert harness.distance(harness.Body(cube), harness.Body("cube.ply", (0, 0, 2))).gap == pytest.approx(
        2 - 1 / np.sqrt(3), rel=1e-12
    )
    assert make_mesh("cube", cube.vertices, cube.faces).digest == harness.Body(cube).mesh.digest


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"position": (1, 2)}, r"position has the shape \(2,\); it must be \(3,\), or \(n, 3\) for n poses"),
        ({"position": [(0, 0, 0), (0, np.nan, 0)]}, "position is not finite, first in row 1"),
        ({"position": "here"}, "position is no array of numbers"),
        ({"quaternion": (0, 0, 0, 0)}, "quaternion is zero"),
        ({"quaternion": (1, 0, 0)}, r"quaternion has the shape \(3,\)"),
        ({"velocity": (np.inf, 0, 0)}, "velocity is not finite"),
        ({"size": 0}, "size is 0; it must be above 0 and finite"),
        ({"size": float("nan")}, "size is nan"),
        ({"shape": "cube"}, "shape is 'cube'; it must be one of sphere, hull, mesh"),
        ({"mesh": "no-such.ply"}, "there is no mesh"),
        ({"mesh": None}, "a body of shape mesh needs a mesh"),
        ({"mesh": 3}, "a mesh is a path or a trimesh.Trimesh, not a int"),
        ({"position": np.zeros((3, 3)), "spin": np.zeros((2, 3))}, "arrays of 2 and 3 rows"),
    ],
)
def test_nonsense_is_refused_in_a_sentence(given, said):
    with pytest.raises(InputError, match=said):
        harness.Body(**({"mesh": "cube.ply"} | given))


def test_bodies_that_do_not_go_together_are_refused():
    cube = harness.Body("cube.ply")
    with pytest.raises(InputError, match="one body's shape is mesh, the other's hull"):
        harness.touching(cube, harness.Body("cube.ply", shape="hull"))
    with pytest.raises(InputError, match="one body has 2 poses, the other 3"):
        harness.distance(*(harness.Body("cube.ply", np.zeros((count, 3))) for count in (2, 3)))
    with pytest.raises(InputError, match="the second body is a str"):
        harness.distance(cube, "cube.ply")
    with pytest.raises(InputError, match="until is nan"):
        harness.time_of_impact(cube, cube, np.nan)
    with pytest.raises(InputError, match="tolerance is 0"):
        harness.time_of_impact(cube, cube, 1.0, 0)
