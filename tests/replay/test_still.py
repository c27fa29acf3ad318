"""The forms and turns of a still picture, against two libraries that it does without."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation
from trimesh.creation import icosphere

from harness.replay.still import _ball, _turns


@pytest.mark.parametrize("halvings", [0, 1, 3])
def test_a_ball_is_an_icosahedron_halved_again_and_again_and_its_faces_look_outward(halvings):
    vertices, faces = _ball(halvings)
    expected = icosphere(subdivisions=halvings, radius=0.5)
    off, place = cKDTree(expected.vertices).query(vertices)
    assert off.max() < 1e-14
    assert sorted(place) == list(range(len(expected.vertices)))
    assert {frozenset(face) for face in place[faces].tolist()} == {frozenset(face) for face in expected.faces.tolist()}
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    assert (np.sum(np.cross(b - a, c - a) * a, axis=1) > 0.0).all()


def test_bodies_are_turned_by_their_quaternions():
    quaternions = np.random.default_rng(0).normal(size=(50, 4))
    assert _turns(quaternions) == pytest.approx(
        Rotation.from_quat(quaternions, scalar_first=True).as_matrix(), abs=1e-14
    )
