"""The reference of gaps holds against exact arithmetic, and errors against it are those that were made."""

import numpy as np
import pytest

from harness.compare.exact import PlacedPoints
from harness.compare.exact_distance import hull_distance, surface_distance
from harness.motion.answers import NearAnswers
from harness.motion.kinematics import Trajectory
from harness.motion.law import MotionLaw
from harness.reference.gap_errors import gap_errors
from harness.reference.near_pairs import near_reference
from harness.reference.triangle_gaps import triangle_gaps
from tests.conftest import random_scene

LAW, WITHIN = MotionLaw(1.0, 0.25, "none"), 0.5


def exact_gap(scene, trajectory, i, j):
    one, other = (
        PlacedPoints(scene.solid_of(1.0).vertices, trajectory.positions[k], trajectory.quaternions[k]) for k in (i, j)
    )
    if scene.shape == "hull":
        return hull_distance(one, other).gap
    faces = scene.mesh.faces
    return surface_distance(one, faces, other, faces).gap


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_bounds_on_gaps_hold_what_exact_arithmetic_finds(shape):
    scene = random_scene(shape, 8, 3.0, 5)
    found = near_reference(scene, LAW, WITHIN)
    assert len(found.at) > 30
    trajectory = Trajectory(scene.bodies, scene.box, folded=True, turning=True)
    for frame, (i, j), lower, upper in zip(found.at, found.pairs, found.lower, found.upper, strict=True):
        trajectory.move_to(frame * LAW.dt)
        gap = exact_gap(scene, trajectory, i, j)
        assert lower - 1e-14 <= gap <= upper + 1e-14
        assert upper - lower <= 1e-13


def test_triangles_of_all_kinds_are_bounded_from_both_sides():
    rng = np.random.default_rng(8)
    one, other = rng.normal(size=(2, 400, 3, 3))
    other[:200] += 2.0 * rng.normal(size=(200, 1, 3))
    found = triangle_gaps(one, other)
    assert (found.lower <= found.upper).all()
    assert (found.upper - found.lower).max() < 1e-12
    assert 50 < np.count_nonzero(found.upper == 0.0) < 350


def answers_of(reference, gaps, rows):
    points = np.full((len(rows), 2, 3), np.nan)
    return NearAnswers(reference.at[rows], reference.pairs[rows], gaps[rows], points)


def test_errors_of_gaps_are_those_that_were_made():
    scene = random_scene("sphere", 12, 3.0, 5)
    truth = near_reference(scene, LAW, WITHIN)
    every = np.arange(len(truth.at))
    right = gap_errors(scene, LAW, truth, answers_of(truth, truth.upper, every), WITHIN)
    assert (right["missed_pairs"], right["extra_pairs"], right["gap_error_most"]) == (0.0, 0.0, 0.0)
    wrong = gap_errors(scene, LAW, truth, answers_of(truth, truth.upper + 0.01, every[1:]), WITHIN)
    assert wrong["missed_pairs"] == pytest.approx(1.0 / len(every))
    assert (wrong["gap_error"], wrong["gap_error_most"]) == pytest.approx((0.01, 0.01))
    nobody = NearAnswers(truth.at, truth.pairs[:, ::-1], truth.upper, np.full((len(every), 2, 3), np.nan))
    extra = gap_errors(scene, LAW, truth, nobody, WITHIN)
    assert (extra["missed_pairs"], extra["extra_pairs"]) == (1.0, 1.0)


@pytest.mark.filterwarnings("error")
def test_triangles_that_cross_are_at_no_distance_without_a_warning():
    """Warnings may be errors to whoever runs the program, and these would end a run."""
    one, other = np.random.default_rng(259).normal(10.0, 1.0, (2, 100, 3, 3))
    found = triangle_gaps(one, other)
    crossing = found.upper == 0.0
    assert 10 < crossing.sum() < 90
    assert not found.lower[crossing].any()
