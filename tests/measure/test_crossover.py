"""A crossing is known to lie between two measured x, at each of which somebody is ahead; nothing more is said."""

import pytest

from harness.measure.crossover import Crossover, crossover


def leaders(text):
    return {float(2**place): "" if who == "-" else who for place, who in enumerate(text)}


@pytest.mark.parametrize(
    ("told", "found"),
    [
        ("aabb", Crossover("b", 4.0, 2.0, False)),
        ("a-bb", Crossover("b", 4.0, 1.0, False)),
        ("a--b", Crossover("b", 8.0, 1.0, False)),
        ("--bb", Crossover("b", 4.0, None, False)),
        ("baab", Crossover("b", 8.0, 4.0, False)),
        ("bbbb", Crossover("b", 1.0, None, True)),
        ("b-bb", Crossover("b", 4.0, None, False)),
    ],
)
def test_the_last_crossing_lies_between_the_last_two_that_are_told_apart(told, found):
    assert crossover(leaders(told)) == found


@pytest.mark.parametrize("told", ["", "a", "aab-", "----"])
def test_nothing_is_said_where_nobody_is_ahead_at_the_largest_x(told):
    assert crossover(leaders(told)) is None
