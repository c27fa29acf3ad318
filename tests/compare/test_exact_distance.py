"""The judge of distances against features in fractions, and certificates that must not pass."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from harness.compare.exact import PlacedPoints
from harness.compare.exact_distance import hull_distance, root, surface_distance
from tests.compare.rational_distances import FORMS, STRAIGHT, wrong_pairs
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import turns


@pytest.mark.slow
def test_the_judge_finds_the_rational_distance_of_random_and_degenerate_pairs():
    assert wrong_pairs(2 * len(FORMS)) == []


@pytest.mark.slow
def test_the_judge_finds_the_rational_distance_of_hundreds_of_pairs():
    assert wrong_pairs(330, seed=1) == []


def cubes(offset, seed=0):
    mesh, q = cube_mesh(), turns(np.random.default_rng(seed), 2)
    return (
        mesh,
        PlacedPoints(mesh.vertices, np.zeros(3), q[0]),
        PlacedPoints(mesh.vertices, np.array(offset, float), q[1]),
    )


def test_the_surface_of_a_convex_mesh_is_as_far_away_as_its_hull():
    for seed in range(5):
        mesh, first, second = cubes((1.1, 0.2, 0.1), seed)
        surface = surface_distance(first, mesh.faces, second, mesh.faces)
        surface.check(first, mesh.faces, second, mesh.faces)
        assert surface.upper == surface.lower == hull_distance(first, second).upper


def test_cubes_face_to_face_are_as_far_apart_as_the_drawing_says():
    mesh = cube_mesh()
    first, second = (PlacedPoints(mesh.vertices, np.array([x, 0, 0]), STRAIGHT) for x in (0.0, 2.0))
    assert hull_distance(first, second).gap == pytest.approx(2 - 1 / np.sqrt(3), rel=1e-15)


def test_a_certificate_of_another_pose_or_with_a_part_left_out_does_not_pass():
    mesh, first, second = cubes((1.1, 0.2, 0.1))
    found = surface_distance(first, mesh.faces, second, mesh.faces)
    moved = replace(second, position=np.array([1.1, 0.2, 0.125]))
    false = [
        replace(found, planes=found.planes[1:]),
        replace(found, lower=found.lower * Fraction(1001, 1000), upper=found.upper * Fraction(1001, 1000)),
        replace(found, lower=found.lower * Fraction(1001, 1000)),
        replace(found, weights=(((0, 1), (7, 1)), found.weights[1])),
    ]
    for wrong in false:
        with pytest.raises(ArithmeticError):
            wrong.check(first, mesh.faces, second, mesh.faces)
    with pytest.raises(ArithmeticError):
        found.check(first, mesh.faces, moved, mesh.faces)


def test_the_root_of_a_fraction_of_any_size_keeps_its_digits():
    for exponent in (-300, -1, 0, 1, 300):
        assert root(Fraction(9) * Fraction(10) ** (2 * exponent)) == pytest.approx(3 * 10.0**exponent, rel=1e-15)
