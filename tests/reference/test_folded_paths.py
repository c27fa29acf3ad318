"""Straight pieces of folded paths, against the closed form of a folded position."""

import numpy as np

from harness.motion.kinematics import Trajectory
from harness.reference.folded_paths import folded_paths, straight_pieces
from harness.scene.box import Box
from tests.conftest import make_bodies
from tests.reference.gas import gas


def test_pieces_follow_upon_each_other_and_are_where_the_bodies_are():
    bodies, box = gas(3, count=2)
    pieces = list(straight_pieces(folded_paths(bodies, box), 0, 1, 0.5, 9.0))
    assert len(pieces) > 10
    assert (pieces[0].begin, pieces[-1].end) == (0.5, 9.0)
    assert [piece.end for piece in pieces[:-1]] == [piece.begin for piece in pieces[1:]]
    flight = Trajectory(bodies, box, folded=True, turning=False)
    for piece in pieces:
        for share in (0.0, 0.3, 1.0):
            time = piece.begin + share * (piece.end - piece.begin)
            flight.move_to(time)
            here = piece.places + piece.velocities * (time - piece.begin)
            np.testing.assert_allclose(here, flight.positions, rtol=0, atol=1e-13)


def test_a_ball_folds_where_it_touches_the_wall_and_then_once_a_width():
    """Its centre has 2 m to each side, and starts in the middle at 1 m/s."""
    bodies = make_bodies([[0, 0, 0], [0, 0, 0]], [[1, 0, 0], [0, 0, 0]])
    pieces = list(straight_pieces(folded_paths(bodies, Box(np.full(3, 2.5))), 0, 1, 0.0, 11.0))
    assert [piece.begin for piece in pieces] == [0, 2, 6, 10]
    assert [piece.places[0, 0] for piece in pieces] == [0, 2, -2, 2]
    assert [piece.velocities[0, 0] for piece in pieces] == [1, -1, 1, -1]


def test_a_body_as_large_as_the_box_stays_in_the_middle():
    bodies = make_bodies([[0.1, 0, 0], [0, 0, 0]], [[1, 2, 3], [0, 0, 0]], sizes=[2.0, 0.5])
    (piece,) = straight_pieces(folded_paths(bodies, Box(np.full(3, 1.0))), 0, 1, 0.0, 5.0)
    assert piece.places[0].tolist() == piece.velocities[0].tolist() == [0, 0, 0]
