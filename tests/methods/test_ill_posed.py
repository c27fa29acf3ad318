"""What a plan says of starts that make a motion ill-posed, against all pairs looked at one by one."""

import numpy as np
import pytest

from harness.methods.ill_posed import FEW, ill_posed
from harness.motion.law import MotionLaw
from harness.scene.box import Box
from harness.scene.launch import place
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies


def spheres(positions, half=(5.0, 5.0, 5.0), **options):
    bodies = make_bodies(positions, np.ones((len(positions), 3)))
    return Scene("sphere", (), bodies, Box(np.array(half)), **options)


def said(scene, response="elastic"):
    return ill_posed(scene, MotionLaw(1.0, 0.1, response))


def test_bodies_that_begin_inside_one_another_are_counted_and_those_that_touch_are_not():
    (sentence,) = said(spheres([(0, 0, 0), (0, 0, 0), (1, 0, 0), (1.9, 0, 0)]))
    assert sentence.startswith("2 pairs of bodies begin inside one another")
    (sentence,) = said(spheres([(0, 0, 0), (0.5, 0, 0)]))
    assert sentence.startswith("1 pair of bodies begins inside one another")
    for positions in ([], [(0, 0, 0)], [(k, 0, 0) for k in range(-2, 3)], [(4.5, 4.5, 4.5), (4.5, 4.5, 3.5)]):
        assert said(spheres(np.reshape(positions, (-1, 3)))) == ()


@pytest.mark.parametrize("count", [FEW, FEW + 100])
def test_as_many_pairs_are_counted_with_a_grid_as_without(count):
    positions = np.random.default_rng(1).uniform(-4.5, 4.5, (count, 3))
    inside = np.triu(np.linalg.norm(positions[:, None] - positions, axis=2) < 1.0, 1).sum()
    assert said(spheres(positions))[0].startswith(f"{inside} pairs of bodies")


def test_nothing_is_ill_posed_where_nothing_moves_no_hit_is_answered_or_a_pair_is_ignored():
    positions = [(0, 0, 0), (0.5, 0, 0)]
    assert said(Scene("sphere", (), make_bodies(positions), Box(np.full(3, 5.0)))) == ()
    assert said(spheres(positions), "none") == ()
    assert said(spheres(positions, ignored=np.array([[0, 1]]))) == ()


def test_of_meshes_only_the_spheres_around_them_are_known_to_overlap():
    bodies = make_bodies([(0, 0, 0), (0.9, 0, 0)], np.ones((2, 3)))
    (sentence,) = said(Scene("mesh", (cube_mesh(),), bodies, Box(np.full(3, 5.0))))
    assert sentence.startswith("the bounding spheres of 1 pair of bodies overlap")


def test_bodies_from_wall_to_wall_have_no_room_along_that_line_and_those_with_a_gap_have():
    eight = place(np.full(8, 0.5), Box(np.ones(3)), np.random.default_rng(0), overlap=False)
    assert said(spheres(eight, (1.0, 1.0, 1.0), apart=True))[0].startswith("bodies have no room along x and y and z,")
    assert said(spheres([(0, 0, 0)], (0.5, 2.0, 2.0)))[0].startswith("bodies have no room along x,")
    row = [(-1, 0, 0), (1, 0.5, 0), (0, 0, 0), (1, -0.6, 0)]
    assert said(spheres(row, (1.5, 3.0, 3.0))) == ()
    row[1] = (1, 0, 0)
    assert "no room along x," in said(spheres(row, (1.5, 3.0, 3.0)))[-1]
    assert said(spheres([(0, 0, 0)], (0.5000005, 2.0, 2.0))) == ()
