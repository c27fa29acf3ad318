"""A method that answers for another shape is not ranked beside those that answer the question."""

from dataclasses import replace

import pytest

from harness.measure.noise import Control
from harness.report.ranking import rank
from harness.report.sentences.crossings import crossing_sentences
from harness.report.sentences.leaders import leader_sentences
from harness.report.series import Arrangement
from harness.report.tables.ranked import ranked_tables
from tests.report.test_crossings import BRUTE_FORCE, GRID, XS, power, series

PLAN = {"warnings": ["APPROXIMATION: hulls replaces each mesh by its convex hull"]}
CONTROL = {"run_seconds": Control((0.01, 0.01, 0.02, 0.02, 0.03))}


def approximating(line):
    points = tuple(replace(point, row=replace(point.row, plan=PLAN)) for point in line.points)
    return replace(line, points=points)


FASTEST = series("hulls", power(1, 0.1))


@pytest.fixture
def told():
    return lambda *lines: Arrangement("count", XS, lines, None, ("run_seconds",), CONTROL)


def labels(arrangement):
    found = rank(arrangement.series, 80, "run_seconds", arrangement.resolution("run_seconds"))
    return [entry.series.label for entry in found]


def test_it_is_ranked_where_it_answers_for_the_bodies_themselves(told):
    assert labels(told(BRUTE_FORCE, GRID, FASTEST)) == ["hulls", "grid", "brute-force"]


def test_it_is_left_out_where_it_does_not_and_the_table_says_so(told):
    arrangement = told(BRUTE_FORCE, GRID, approximating(FASTEST))
    assert labels(arrangement) == ["grid", "brute-force"]
    assert not any("hulls" in str(line) for line in leader_sentences(arrangement))
    assert not any("hulls" in str(line) for line in crossing_sentences(arrangement))
    assert "Not ranked where others are: hulls, for another shape" in ranked_tables(arrangement)[0].note
    assert "another shape" not in ranked_tables(told(BRUTE_FORCE, GRID))[0].note


def test_where_all_do_they_are_ranked_among_themselves(told):
    arrangement = told(approximating(GRID), approximating(FASTEST))
    assert labels(arrangement) == ["hulls", "grid"]
    assert "another shape" not in ranked_tables(arrangement)[0].note
