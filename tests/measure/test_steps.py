"""Steps of a series: none are named in noise, and those that are there are found where they are."""

import math

import numpy as np
import pytest

from harness.measure.noise import level
from harness.measure.steps import candidates, common_noise

FLOOR = math.log1p(0.1)
POINTS = 60


def named(series):
    """(series, place) of every step that counts when all of them are looked at."""
    common = common_noise(series)
    found = [candidates(values, common, FLOOR) for values in series]
    counting = level([p for steps in found for p in [step.p_value for step in steps] or [1.0]])
    return [(k, step.place) for k, steps in enumerate(found) for step in steps if step.p_value <= counting]


def noise(rng, kind, sweeps):
    """Logarithms of times of points in which nothing changes."""
    sizes = {"even": [0.04], "outliers": [0.04], "uneven": [0.01, 0.03, 0.1]}[kind]
    values = rng.standard_t(3, (POINTS, sweeps)) if kind == "outliers" else rng.standard_normal((POINTS, sweeps))
    return values * rng.choice(sizes, POINTS)[:, None]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["even", "uneven", "outliers"])
def test_where_nothing_changes_fewer_than_one_history_in_twenty_names_a_step(kind):
    rng = np.random.default_rng(19)
    histories = 40
    false = sum(bool(named(noise(rng, kind, sweeps))) for sweeps in (4, 6, 10, 20) for _ in range(histories // 4))
    assert false < 0.05 * histories


@pytest.mark.parametrize("kind", ["even", pytest.param("uneven", marks=pytest.mark.slow)])
def test_a_step_of_a_half_is_found_where_it_is(kind):
    rng = np.random.default_rng(7)
    found = 0
    for _ in range(10):
        series = noise(rng, kind, 10)
        series[0, 6:] += math.log(1.5)
        found += named(series) == [(0, 6)]
    assert found >= 7


def test_a_single_outlier_is_no_step():
    series = 0.01 * np.random.default_rng(3).standard_normal((POINTS, 9))
    series[5, 4] += 1.0
    assert named(series) == []


def test_up_and_down_again_are_two_steps():
    series = 0.01 * np.random.default_rng(3).standard_normal((POINTS, 12))
    series[5, 4:8] += 0.5
    assert named(series) == [(5, 4), (5, 8)]


def test_a_change_below_the_floor_is_none_however_quiet_the_machine():
    series = 1e-4 * np.random.default_rng(3).standard_normal((POINTS, 12))
    series[5, 6:] += math.log(1.08)
    assert named(series) == []
