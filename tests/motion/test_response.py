"""CollisionResponse to hits against the laws they must obey."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from harness.motion.response import CollisionResponse

vectors = st.tuples(*[st.floats(-3, 3)] * 3)


def answer(positions, velocities, *, masses=(1.0, 1.0), response="elastic", restitution=1.0, pairs=((0, 1),)):
    positions, velocities = np.array(positions, float), np.array(velocities, float)
    response = CollisionResponse(np.array(masses, float), response, restitution)
    hits = response.pairs(np.array(pairs), positions, velocities)
    return velocities, hits, response


def test_equal_masses_head_on_swap_their_velocities():
    for response in ("reflect", "elastic"):
        after, hits, _ = answer([[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [-2, 0, 0]], response=response)
        expected = [[-1, 0, 0], [2, 0, 0]] if response == "reflect" else [[-2, 0, 0], [1, 0, 0]]
        assert after.tolist() == expected
        assert hits.tolist() == [True]


@pytest.mark.parametrize("ratio", [1e6, 1e12])
def test_a_heavy_body_hands_on_what_its_mass_ratio_says(ratio):
    after, _, _ = answer([[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [0, 0, 0]], masses=(ratio, 1.0))
    total = ratio + 1.0
    assert after[0, 0] == pytest.approx((ratio - 1.0) / total, rel=2e-16)
    assert after[1, 0] == pytest.approx(2.0 * ratio / total, rel=4e-16)


@pytest.mark.parametrize("response", ["elastic", "reflect"])
@pytest.mark.parametrize("apart", [1e-100, 2.73710616e-163, 5e-324])
def test_centres_nearly_in_one_place_answer_along_the_line_between_them(apart, response):
    after, hits, _ = answer([[0, 0, 0], [0, -apart, 0]], [[0, 0, 0], [0, 1, 0]], response=response)
    assert hits.tolist() == [True]
    assert after.tolist() == ([[0, 1, 0], [0, 0, 0]] if response == "elastic" else [[0, 0, 0], [0, -1, 0]])


@given(vectors, vectors, vectors, st.floats(0.1, 10), st.floats(0, 1))
@example((0.0, -2.737106163722177e-163, 0.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1.0, 0.0)
def test_elastic_keeps_momentum_and_turns_the_approach_by_the_restitution(gap, u, v, mass, restitution):
    gap = np.array(gap)
    before = np.array([u, v])
    after, hits, response = answer([[0, 0, 0], gap], before, masses=(1.0, mass), restitution=restitution)
    for _ in range(2):
        gap = gap * 2.0**500 if np.dot(gap, gap) < 1e-280 else gap  # or its products would be rounded to nothing
    approach = np.dot(before[1] - before[0], gap)
    assert hits[0] == (approach < 0)
    assert np.allclose(after[0] + mass * after[1], before[0] + mass * before[1], atol=1e-12)
    assert response.momentum_added < 1e-13
    if hits[0] and 1e-12 < np.dot(gap, gap) < 1e12:
        assert np.dot(after[1] - after[0], gap) == pytest.approx(-restitution * approach, abs=1e-10)


@given(vectors, vectors, vectors)
def test_reflect_keeps_the_speed_of_each_body(gap, u, v):
    if np.dot(gap, gap) < 1e-12:
        return
    before = np.array([u, v])
    after, _, _ = answer([[0, 0, 0], gap], before, response="reflect")
    assert np.allclose(np.linalg.norm(after, axis=1), np.linalg.norm(before, axis=1), atol=1e-13)


def test_overlapping_bodies_that_separate_are_left_alone():
    after, hits, response = answer([[0, 0, 0], [0.1, 0, 0]], [[-1, 0, 0], [1, 0, 0]])
    assert after.tolist() == [[-1, 0, 0], [1, 0, 0]]
    assert not hits[0]
    assert not response.changed.any()


def test_concentric_bodies_have_no_normal_and_are_left_alone():
    after, hits, _ = answer([[0, 0, 0], [0, 0, 0]], [[1, 0, 0], [-1, 0, 0]])
    assert after.tolist() == [[1, 0, 0], [-1, 0, 0]]
    assert not hits[0]


def test_pairs_are_answered_in_order_each_with_what_the_earlier_left():
    positions, velocities = [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[1, 0, 0], [0, 0, 0], [0, 0, 0]]
    after, hits, _ = answer(positions, velocities, masses=(1, 1, 1), pairs=((0, 1), (1, 2)))
    assert after[:, 0].tolist() == [0, 0, 1]
    assert hits.tolist() == [True, True]


def test_a_wall_flips_only_what_approaches_it():
    velocities = np.array([[-1.0, 2.0, 3.0], [1.0, -2.0, -3.0]])
    touching = np.zeros((2, 6), bool)
    touching[:, 0] = touching[:, 3] = True  # x- and y+
    response = CollisionResponse(np.ones(2), "reflect", 1.0)
    hits = response.walls(touching, velocities)
    assert velocities.tolist() == [[1, -2, 3], [1, -2, -3]]
    assert np.argwhere(hits).tolist() == [[0, 0], [0, 3]]
    assert response.changed.tolist() == [True, False]


def test_a_corner_flips_all_three_components():
    velocities = np.array([[1.0, 1.0, 1.0]])
    hits = CollisionResponse(np.ones(1), "reflect", 1.0).walls(np.ones((1, 6), bool), velocities)
    assert velocities.tolist() == [[-1, -1, -1]]
    assert hits.tolist() == [[False, True, False, True, False, True]]
