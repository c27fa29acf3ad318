"""What a backend answers is held to its form, and what is wrong with it is told with the backend's name."""

import numpy as np
import pytest

from harness.backends.contract import (
    ContractError,
    made,
    read_only,
    require_counters,
    require_gaps,
    require_impacts,
    require_pairs,
)
from harness.backends.protocol import queries, set_accuracy

PAIRS = [[0, 1], [0, 2]]
POINTS = np.zeros((2, 2, 3))


def nowhere(points):
    """The same points, those of the second pair not a number."""
    return np.where(np.arange(2)[:, None, None] == 1, np.nan, points)


def test_gaps_come_back_as_they_are():
    for points in (None, POINTS):
        found = require_gaps("mine", (PAIRS, [0.0, 0.5], points), 3, 0.5)
        assert found.pairs.tolist() == PAIRS
        assert found.gaps.tolist() == [0.0, 0.5]
        assert found.points is points
    empty = require_gaps("mine", (np.empty((0, 2), np.int64), [], None), 3, 0.5)
    assert (empty.pairs.shape, empty.gaps.shape) == ((0, 2), (0,))


def test_only_pairs_that_touch_may_be_without_nearest_points():
    assert require_gaps("mine", (PAIRS, [0.5, 0.0], nowhere(POINTS)), 3, 0.5).gaps.tolist() == [0.5, 0.0]
    with pytest.raises(ContractError, match=r'backend "mine": the nearest points of \(0, 2\) are not finite'):
        require_gaps("mine", (PAIRS, [0.5, 0.25], nowhere(POINTS)), 3, 0.5)


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        (PAIRS, "must be a tuple of pairs, gaps, points"),
        ((PAIRS, [0.0, 0.0]), "must be a tuple of pairs, gaps, points"),
        ((PAIRS[::-1], [0.0, 0.0], None), "not sorted"),
        (([[1, 0]], [0.0], None), "i < j"),
        ((PAIRS, [0.0], None), r"gaps must be a float array of shape \(2,\)"),
        ((PAIRS, [0, 0], None), "not int64"),
        ((PAIRS, [0.0, 0.6], None), r"the gap of \(0, 2\) must be from 0 to 0.5 m, not 0.59999999999999998"),
        ((PAIRS, [-1.0, 0.0], None), r"the gap of \(0, 1\) .* not -1"),
        ((PAIRS, [0.0, np.nan], None), "not nan"),
        ((PAIRS, [0.0, np.inf], None), "not inf"),
        ((PAIRS, [0.0, 0.0], POINTS[:1]), r"nearest points must be a float array of shape \(2, 2, 3\)"),
    ],
)
def test_gaps_that_break_the_contract_are_refused(answer, told):
    with pytest.raises(ContractError, match=told) as error:
        require_gaps("mine", answer, 3, 0.5)
    assert str(error.value).startswith('backend "mine": ')


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ((PAIRS, [0.0, 0.1], None), "must be a tuple of pairs, times"),
        ((PAIRS, [0.0, 0.6]), r"the time of \(0, 2\) must be from 0 to 0.5 s"),
        ((PAIRS, [np.nan, 0.1]), r"the time of \(0, 1\)"),
        (([[0, 3]], [0.1]), "no such pair of 3 bodies"),
        (([[0, 1], [0, 1]], [0.1, 0.2]), "there twice"),
    ],
)
def test_impacts_that_break_the_contract_are_refused(answer, told):
    with pytest.raises(ContractError, match=told):
        require_impacts("mine", answer, 3, 0.5)
    assert require_impacts("mine", (PAIRS, [0.0, 0.5]), 3, 0.5).times.tolist() == [0.0, 0.5]


def test_a_backend_that_does_not_say_answers_collisions_alone_and_has_no_knob():
    class Plain:
        pass

    class Tunable:
        queries, accuracy = ("collision", "distance"), 1e-6

    plain, tunable = Plain(), Tunable()
    assert queries(plain) == ("collision",)
    assert queries(tunable) == ("collision", "distance")
    assert not set_accuracy(plain, 1e-3)
    assert set_accuracy(tunable, 1e-3)
    assert tunable.accuracy == 1e-3


@pytest.mark.parametrize(
    ("counters", "told"),
    [
        (7, "must be numbers by name, not int"),
        ({"frames": 1}, "it cannot count frames, only pair_tests, narrow_tests"),
        ({"energy_drift": 0.0}, "it cannot count energy_drift"),
        ({"narrow_tests": -5}, "its counter narrow_tests must be 0 or more, not -5"),
        ({"narrow_tests": np.nan}, "not nan"),
        ({"narrow_tests": "many"}, "not 'many'"),
    ],
)
def test_counters_that_count_no_work_are_refused(counters, told):
    with pytest.raises(ContractError, match=told):
        require_counters("mine", counters)


def test_counters_stay_whole_numbers():
    assert repr(require_counters("mine", {"pair_tests": np.int64(3), "fcl_tests": 0})) == (
        "{'pair_tests': 3, 'fcl_tests': 0}"
    )


class Lazy:
    """An answer that is worked out when somebody looks at it."""

    looked_at = 0

    def __array__(self, dtype=None, copy=None):
        self.looked_at += 1
        return np.array(PAIRS)


def test_an_answer_that_is_worked_out_later_is_worked_out_at_once_and_once():
    lazy = Lazy()
    found = made((lazy, [0.0, 0.5], None))
    assert [type(part) for part in found[:2]] == [np.ndarray, np.ndarray]
    assert require_gaps("mine", found, 3, 0.5).pairs.tolist() == PAIRS
    assert lazy.looked_at == 1
    assert made(None) is None
    with pytest.raises(ContractError, match="is no array"):
        require_pairs("mine", made([[0, 1], [2]]), 3)


@pytest.mark.parametrize("count", [0, 3])
def test_poses_can_neither_be_written_to_nor_made_writable(count):
    poses = np.zeros((count, 3))
    given = read_only(poses)
    assert given.shape == (count, 3)
    with pytest.raises(ValueError, match="read-only"):
        given[:] = 1.0
    with pytest.raises(ValueError, match="cannot set WRITEABLE"):
        given.flags.writeable = True
    poses[:] = 2.0
    assert (given == 2.0).all()
