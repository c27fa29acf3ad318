"""Crossovers against power laws whose crossing is known."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.measure.crossover import crossover

XS = (4.0, 8.0, 16.0, 32.0, 64.0)


def power(factor, exponent, noise=(1.0,)):
    return {x: {repeat: factor * x**exponent * by for repeat, by in enumerate(noise)} for x in XS}


@given(st.floats(5, 60))
def test_two_power_laws_cross_where_their_formulas_do(at):
    found = crossover(power(1.0, 2.0), power(at, 1.0))
    assert found.ahead == "b"
    assert found.at.median == pytest.approx(at, rel=1e-9)


def test_the_interval_is_that_of_the_repeats():
    found = crossover(power(1.0, 2.0, (1, 1, 1, 1, 1)), power(1.0, 1.0, (10, 11, 12, 13, 14)))
    assert (found.at.median, found.at.low, found.at.high) == pytest.approx((12, 10, 14))


def test_methods_that_never_cross_say_who_is_ahead():
    assert crossover(power(1.0, 1.0), power(2.0, 1.0)) == crossover(power(1.0, 1.0), power(3.0, 1.0))
    assert crossover(power(1.0, 1.0), power(2.0, 1.0)).ahead == "a"
    assert crossover(power(1.0, 1.0), power(2.0, 1.0)).at is None


def test_nothing_is_said_where_nothing_is_shared():
    assert crossover({4.0: {0: 1.0}}, {4.0: {0: 1.0}}) is None
    assert crossover(power(1, 1), {}) is None
    assert crossover({4.0: {0: 1.0}, 8.0: {0: 1.0}}, {4.0: {1: 1.0}, 8.0: {1: 1.0}}) is None
