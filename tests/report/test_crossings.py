"""Sentences about who overtakes whom."""

import pandas as pd
import pytest

from harness.report.point import MeasuredPoint
from harness.report.sentences.crossings import crossing_sentences
from harness.report.series import Arrangement, Series
from harness.store.records import PointRow


def series(label, exponent, factor, box=1.0):
    points = []
    for count in (10, 20, 40, 80):
        costs = [factor * count**exponent] * 5
        runs = pd.DataFrame({"repeat": range(5), "status": "ok", "machine": "m", "run_seconds": costs})
        points.append(
            MeasuredPoint(PointRow(f"{label}{count}", {"count": count, "algorithm": label, "box_ratio": box}), runs)
        )
    return Series(label, 0, "", tuple(points), (10, 20, 40, 80))


def sentences(*lines, metric="run_seconds"):
    return crossing_sentences(Arrangement("count", (10, 20, 40, 80), lines, None, (metric,)))


def test_the_crossing_of_each_pair_of_methods_is_told():
    found = sentences(series("brute-force", 2, 1.0), series("grid", 1, 25.0), series("slow", 2, 100.0))
    assert len(found) == 3
    assert found[0].startswith("From count <strong>25</strong>")
    assert "grid has a lower" in found[0]
    assert "they do not cross" in found[1]


def test_methods_on_different_scenes_are_not_compared():
    assert sentences(series("brute-force", 2, 1.0), series("grid", 1, 25.0, box=2.0)) == []


@pytest.mark.parametrize("metric", ["pair_tests", "frames_per_second"])
def test_only_costs_in_time_cross(metric):
    assert sentences(series("brute-force", 2, 1.0), series("grid", 1, 25.0), metric=metric) == []
