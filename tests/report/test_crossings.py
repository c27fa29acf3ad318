"""Sentences about who overtakes whom."""

import numpy as np
import pandas as pd
import pytest

from harness.measure.noise import Control
from harness.report.point import MeasuredPoint
from harness.report.sentences.crossings import crossing_sentences
from harness.report.series import Arrangement, Series
from harness.store.records import PointRow

XS = (10, 20, 40, 80)
NOISE = (1.0, 1.01, 0.99, 1.02, 0.98)


def series(label, costs, box=1.0, noise=NOISE):
    points = []
    for count, cost in zip(XS, costs, strict=True):
        runs = pd.DataFrame({"repeat": range(5), "status": "ok", "machine": "m", "run_seconds": cost * np.array(noise)})
        points.append(
            MeasuredPoint(PointRow(f"{label}{count}", {"count": count, "algorithm": label, "box_ratio": box}), runs)
        )
    return Series(label, 0, "", tuple(points), XS)


def power(exponent, factor):
    return [factor * count**exponent for count in XS]


def sentences(*lines, metric="run_seconds", controls=None):
    known = {"run_seconds": Control((0.01, 0.01, 0.02, 0.02, 0.03))} if controls is None else controls
    return [str(sentence) for sentence in crossing_sentences(Arrangement("count", XS, lines, None, (metric,), known))]


BRUTE_FORCE, GRID, SLOW = (
    series("brute-force", power(2, 1.0)),
    series("grid", power(1, 25.0)),
    series("slow", power(2, 100.0)),
)


def test_the_crossing_of_each_pair_of_methods_lies_between_measured_x():
    found = sentences(BRUTE_FORCE, GRID, SLOW)
    assert len(found) == 3
    assert found[0] == (
        "From count <strong>40</strong> on, grid has a lower run time than brute-force; at 20 it is the other way "
        "round: they cross between <strong>20</strong> and 40."
    )
    assert found[1] == ("At every count measured, brute-force has a lower run time than slow: they do not cross there.")


def test_a_crossing_of_costs_with_a_kink_is_held_by_its_interval():
    """A grid that pays for its cells up to 70 bodies: a straight line on logarithmic axes would cross near 48."""
    found = sentences(BRUTE_FORCE, series("grid", [160.0, 600.0, 2400.0, 100.0]))
    assert "they cross between <strong>40</strong> and 80" in found[0]


def test_equal_methods_neither_cross_nor_stay_apart():
    again = series("again", power(2, 1.0), noise=(1.01, 1.0, 1.0, 1.01, 0.99))
    assert sentences(BRUTE_FORCE, again) == []


def test_below_the_x_from_which_one_is_ahead_equals_are_called_that():
    found = sentences(BRUTE_FORCE, series("grid", [100.0, 400.0, 1600.0, 3200.0], noise=(1.01, 1.0, 1.0, 1.01, 0.99)))
    assert found == [
        "From count <strong>80</strong> on, grid has a lower run time than brute-force; at smaller ones they cannot "
        "always be told apart."
    ]


def test_without_a_control_nobody_is_ahead_of_anybody():
    assert sentences(BRUTE_FORCE, GRID, SLOW, controls={}) == []


def test_methods_on_different_scenes_are_not_compared():
    assert sentences(BRUTE_FORCE, series("grid", power(1, 25.0), box=2.0)) == []


@pytest.mark.parametrize("metric", ["pair_tests", "frames_per_second"])
def test_only_costs_in_time_cross(metric):
    assert sentences(BRUTE_FORCE, GRID, metric=metric) == []
