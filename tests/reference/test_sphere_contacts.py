"""Contacts of folded paths, against closed forms, a search in fifty digits, and dense sampling."""

from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.errors import InputError
from harness.motion.kinematics import Trajectory
from harness.reference.sphere_contacts import sphere_contacts
from harness.scene.box import Box
from tests.conftest import make_bodies
from tests.motion.slow_reference import PAIR, Reference
from tests.reference.gas import gas

WIDE = Box(np.full(3, 100.0))


def contacts(positions, velocities, duration=10.0, box=WIDE, **options):
    found = sphere_contacts(make_bodies(positions, velocities, **options), box, duration)
    return list(zip(found.pairs.tolist(), found.onset.tolist(), found.release.tolist(), strict=True))


def test_a_head_on_passage_lasts_from_the_sum_of_radii_to_the_sum_of_radii():
    assert contacts([[-2, 0, 0], [2, 0, 0]], [[1, 0, 0], [-1, 0, 0]]) == [([0, 1], 1.5, 2.5)]


def test_an_offset_passage_is_shorter_by_pythagoras():
    ((_, onset, release),) = contacts([[0, 0.6, 0], [5, 0, 0]], [[2, 0, 0], [0, 0, 0]])
    assert onset == pytest.approx((5 - 0.8) / 2, abs=1e-15)
    assert release == pytest.approx((5 + 0.8) / 2, abs=1e-15)


def test_a_grazing_pass_is_a_contact_only_within_the_sum_of_radii():
    for offset, count in ((1 - 1e-12, 1), (1, 1), (1 + 1e-12, 0)):
        assert len(contacts([[0, offset, 0], [5, 0, 0]], [[2, 0, 0], [0, 0, 0]])) == count


def test_a_hundred_million_diameters_away_no_digit_of_the_offset_is_lost():
    far = Box(np.full(3, 1e9))
    for offset, count in ((1 - 1e-9, 1), (1 + 1e-9, 0)):
        assert len(contacts([[0, offset, 0], [1e8, 0, 0]], [[1e7, 0, 0], [0, 0, 0]], 20.0, far)) == count


def test_what_overlaps_at_rest_touches_all_the_time_and_what_is_apart_never():
    assert contacts([[0, 0, 0], [0.5, 0, 0], [5, 0, 0]], np.zeros((3, 3))) == [([0, 1], 0.0, 10.0)]


def test_a_contact_at_the_start_and_one_at_the_end_are_cut_to_the_duration():
    found = contacts([[0, 0, 0], [0.5, 0, 0], [4, 0, 0]], [[0, 0, 0], [1, 0, 0], [-1, 0, 0]], 3.25)
    assert found == [([0, 1], 0.0, 0.5), ([0, 2], 3.0, 3.25), ([1, 2], 1.25, 2.25)]


def test_a_ball_that_comes_back_from_the_wall_touches_again():
    """Between walls at ±4.5 for its centre, at unit speed, it passes the resting one every nine seconds."""
    found = contacts([[0, 0, 0], [0, 0, 0]], [[0, 0, 0], [1, 0, 0]], 28.0, Box(np.full(3, 5.0)))
    assert [(onset, release) for _, onset, release in found] == [(0, 1), (8, 10), (17, 19), (26, 28)]


def test_a_fold_in_the_middle_of_a_contact_does_not_cut_it():
    """The second ball turns round at the wall, at t = 1, while it touches the first, which rests there."""
    found = contacts([[4.5, 0, 0], [3.5 - 1e-9, 0.3, 0]], [[0, 0, 0], [1, 0, 0]], 3.0, Box(np.full(3, 5.0)))
    assert len(found) == 1


@pytest.mark.parametrize("seed", range(3))
def test_every_onset_is_that_of_a_search_in_fifty_digits_event_for_event(seed):
    bodies, box = gas(seed, count=6)
    duration = 20.0
    with localcontext() as context:
        context.prec = 50
        exact = Reference(
            *([[Decimal(x) for x in row] for row in rows.tolist()] for rows in (bodies.positions, bodies.velocities)),
            *([Decimal(x) for x in row.tolist()] for row in (bodies.radii, bodies.masses, box.half)),
            response="none", root=Decimal.sqrt,
        )  # fmt: skip
        while exact.time < duration:
            exact.step()
        hits = [(i, j, time) for time, kind, i, j in exact.events if kind == PAIR and time <= duration]
        expected = sorted((i, j, float(time)) for i, j, time in hits)
    found = sphere_contacts(bodies, box, duration)
    begun = found.begin_until(duration)
    onsets = [
        (*pair, time) for pair, time in zip(found.pairs[begun].tolist(), found.onset[begun].tolist(), strict=True)
    ]
    assert [event[:2] for event in onsets] == [event[:2] for event in expected]
    assert len(onsets) > 20
    np.testing.assert_allclose([event[2] for event in onsets], [event[2] for event in expected], rtol=0, atol=1e-13)


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_frames_touch_exactly_within_the_contacts(seed):
    bodies, box = gas(seed)
    found = sphere_contacts(bodies, box, 4.0)
    trajectory = Trajectory(bodies, box, folded=True, turning=False)
    first, second = np.triu_indices(len(bodies), 1)
    reach = bodies.radii[first] + bodies.radii[second]
    for time in np.random.default_rng(seed).uniform(0, 4.0, 50):
        trajectory.move_to(time)
        gaps = np.linalg.norm(trajectory.positions[first] - trajectory.positions[second], axis=1) - reach
        open_now = (found.onset <= time) & (time <= found.release)
        touching = set(map(tuple, found.pairs[open_now].tolist()))
        clear = np.abs(gaps) > 1e-9
        seen = {(i, j) for i, j in zip(first[clear], second[clear], strict=True) if (i, j) in touching}
        assert seen == {(i, j) for i, j in zip(first[clear & (gaps < 0)], second[clear & (gaps < 0)], strict=True)}


@pytest.mark.parametrize("windows", [3, 50])
def test_looking_only_at_neighbours_window_by_window_finds_the_same(windows):
    bodies, box = gas(5, count=30, half=(3.0, 3.0, 3.0))
    whole, cut = sphere_contacts(bodies, box, 5.0), sphere_contacts(bodies, box, 5.0, windows)
    assert np.array_equal(whole.pairs, cut.pairs)
    np.testing.assert_allclose(whole.onset, cut.onset, rtol=0, atol=1e-13)
    np.testing.assert_allclose(whole.release, cut.release, rtol=0, atol=1e-13)


def test_one_body_and_none_have_no_contacts():
    for count in (0, 1):
        bodies = make_bodies(np.zeros((count, 3)), np.ones((count, 3)))
        found = sphere_contacts(bodies, WIDE, 1.0)
        assert len(found) == 0


def test_a_body_that_crosses_the_box_without_end_is_refused():
    with pytest.raises(InputError, match=r"walls reflect the bodies 1e\+18 times"):
        contacts([[0, 0, 0], [1, 1, 0]], [[2e19, 0, 0], [0, 0, 0]])


@pytest.mark.slow
def test_bodies_that_fly_very_many_sizes_are_searched_for_in_no_more_windows_than_are_worth_it():
    assert contacts([[0, 0, 0], [0, 1, 1]], [[1e8, 0, 0], [1e8, 0, 0]], sizes=[1e-30, 1e-30]) == []
