"""What the statistics promise, checked by simulation: coverage of intervals, and no winner among equals."""

import numpy as np
import pytest

from harness.measure.noise import Control, distinguishable, level, noise_floor, sign_test
from harness.measure.resolution import Resolution
from harness.measure.statistics import paired_ratio, summary
from tests.conftest import slow_beyond

NOISES = {
    "normal": lambda rng, shape: rng.normal(10.0, 1.0, shape),
    "skewed": lambda rng, shape: rng.lognormal(0.0, 0.5, shape),
    "spiky": lambda rng, shape: rng.exponential(1.0, shape) ** 2,
}
MEDIANS = {"normal": 10.0, "skewed": 1.0, "spiky": np.log(2.0) ** 2}


@pytest.mark.slow
@pytest.mark.parametrize("noise", NOISES)
@pytest.mark.parametrize("repeats", [5, 6, 8, 11, 20])
def test_an_interval_holds_the_median_as_often_as_it_says(noise, repeats):
    samples = NOISES[noise](np.random.default_rng(repeats), (2000, repeats))
    found = [summary(sample) for sample in samples]
    held = np.mean([one.low <= MEDIANS[noise] <= one.high for one in found])
    assert abs(held - found[0].coverage) < 0.03


def clocks(rng, trials, arms, repeats=5):
    """Times of equal methods as a busy machine has them: drift shared by a block, noise of each run, a rare hiccup."""
    drift = rng.lognormal(0.0, 0.1, (trials, repeats, 1))
    hiccups = np.where(rng.random((trials, repeats, arms)) < 0.05, 1.3, 1.0)
    return drift * hiccups * rng.lognormal(0.0, 0.02, (trials, repeats, arms))


def winner(times, floor):
    """Whether the arm with the lowest median is told apart from every other one, as the pages rank."""
    order = np.argsort(np.median(times, axis=0))
    best, *others = (times[:, arm] for arm in order)
    return all(distinguishable(paired_ratio(other, best), floor) for other in others)


@pytest.mark.parametrize("arms", slow_beyond([2, 3, 6]))
def test_equal_methods_have_no_winner_in_95_of_100_trials(arms):
    trials = clocks(np.random.default_rng(arms), 1000, arms + 1)
    # the control is the first arm's second run in each block
    won = [winner(times[:, :arms], noise_floor(times[:, 0], times[:, arms])) for times in trials]
    assert np.mean(won) <= 0.05


def test_without_the_control_two_equal_methods_have_a_winner_too_often():
    trials = clocks(np.random.default_rng(2), 1000, 2)
    assert np.mean([winner(times, 0.0) for times in trials]) > 0.05


def test_a_difference_of_a_tenth_is_told_unless_a_hiccup_hides_it():
    """One of the faster arm's five runs has a hiccup in 23 of 100 trials, and then the intervals overlap."""
    trials = clocks(np.random.default_rng(3), 300, 3) * np.array([1.0, 1.1, 1.0])
    assert np.mean([winner(times[:, :2], noise_floor(times[:, 0], times[:, 2])) for times in trials]) > 0.6


def test_the_floor_is_how_far_equal_runs_typically_are_apart_whichever_is_the_slower():
    assert noise_floor([1.0] * 5, [1.0, 1.02, 0.97, 1.9, 1.01]) == pytest.approx(0.02)
    assert noise_floor([0.9] * 5, [1.0] * 5) == noise_floor([1.0] * 5, [0.9] * 5) == pytest.approx(1 / 0.9 - 1)


def test_fewer_than_five_pairs_tell_no_floor():
    assert noise_floor([1.0] * 4, [1.1] * 4) is None
    assert noise_floor([], []) is None


QUIET = Control((0.001, 0.002, 0.003, 0.004, 0.005))


@pytest.mark.parametrize(
    ("ratios", "chance"),
    [
        ([1.1, 1.1, 1.1, 1.1, 1.1], 1 / 16 / 252),  # beyond all five of the control, which five of ten are once in 252
        ([1.1, 1.1, 1.1, 1.1, 1.0045], 1 / 16 / 42),  # beyond four of them
        ([1.0005] * 5, 1 / 16),  # beyond none: five coins alike
        ([1.1, 1.1, 1.1, 1.1, 0.9], 1.0),
    ],
)
def test_a_sign_test_against_the_control_is_exact(ratios, chance):
    assert sign_test(np.sort(np.log(ratios)), QUIET) == pytest.approx(chance)
    assert sign_test(np.sort(-np.log(ratios)), QUIET) == pytest.approx(chance)


@pytest.mark.parametrize(("n", "controls"), [(5, 5), (6, 6), (9, 5), (20, 20)])
def test_a_p_value_of_equals_is_no_smaller_than_it_says(n, controls):
    """Even of Cauchy noise, which has no mean."""
    rng = np.random.default_rng(n)
    found = []
    for _ in range(2000):
        known = Control(tuple(sorted(np.abs(rng.standard_cauchy(controls)))))
        found.append(sign_test(np.sort(rng.standard_cauchy(n)), known))
    for chance in (0.1, 0.05, 0.01):
        assert np.mean(np.array(found) <= chance) <= chance * 1.2


def test_the_level_is_that_of_benjamini_and_hochberg():
    assert level([0.01, 0.02, 0.9, 0.03]) == 0.03  # the third of four may be 0.0375
    assert level([0.01, 0.9, 0.9, 0.03]) == 0.01
    assert level([0.02, 0.9, 0.9, 0.9]) == 0.0
    assert level([]) == 0.05


@pytest.mark.parametrize("repeats", [1, 2, 3, 4])
def test_nothing_is_told_of_fewer_than_five_repeats(repeats):
    assert Resolution(QUIET).tell([2.0] * repeats) == "few"


def test_nothing_is_told_without_a_control_and_everything_of_counts():
    assert Resolution(None).tell([2.0] * 5) == "uncontrolled"
    assert Resolution(QUIET).tell([2.0, 2.1, 2.0, 2.1, 2.0]) == "apart"
    assert Resolution(QUIET).tell([2.0, 2.1, 2.0, 2.1, 0.9]) == "same"
    assert Resolution(QUIET, level=1e-6).tell([2.0, 2.1, 2.0, 2.1, 2.0]) == "same"
    assert Resolution(exact=True).tell([1.001]) == "apart"
    assert Resolution(exact=True).tell([1.0]) == "same"
