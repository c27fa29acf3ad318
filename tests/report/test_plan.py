"""The plan on the page."""

import pandas as pd

from harness.report.plan import stages
from harness.report.point import MeasuredPoint
from harness.report.series import Arrangement, Series
from harness.store.records import PointRow


def arrangement(*plans):
    points = tuple(
        MeasuredPoint(PointRow(str(place), {}, {"stages": plan}), pd.DataFrame({"status": []}))
        for place, plan in enumerate(plans)
    )
    return Arrangement("count", (1, 2), (Series("fcl", 0, "", points, (1, 2)),), None, ())


def stage(kept, why):
    return {"name": "pairs", "kept": kept, "why": why}


def test_reasons_that_differ_in_numbers_only_are_one():
    (found,) = stages(arrangement([stage(True, "all 10 pairs of 5")], [stage(True, "all 780 pairs of 40")]))
    assert (found.why, found.where) == ("all 10 … 780 pairs of 5 … 40", "all points")


def test_a_stage_that_goes_both_ways_is_told_both_ways():
    kept, left = stages(arrangement([stage(True, "two bodies")], [stage(False, "one body")]))
    assert (kept.kept, kept.where, left.kept, left.why) == (True, "1 of 2\u00a0points", False, "one body")
