"""The error of a run follows from its question, and only answers to one question are held against each other."""

import pytest

from harness.report.accuracy.error_kind import GAPS, TIMES, error_kind
from harness.vocabulary import MethodName


def test_distances_are_judged_by_their_gaps_and_everything_else_by_its_times():
    assert error_kind({"query": "distance"}) is GAPS
    for query in ("collision", "impact", None):
        assert error_kind({"query": query}) is TIMES


@pytest.mark.parametrize(
    ("shape", "query", "knob"),
    [("mesh", "collision", "dt"), ("mesh", "impact", "tolerance"), ("hull", "distance", "tolerance"),
     ("sphere", "impact", "")],
)  # fmt: skip
def test_what_trades_accuracy_for_time_is_the_frame_only_where_frames_are_all_that_is_seen(shape, query, knob):
    assert MethodName("fcl", "grid", shape, query).knob == knob


def test_kernels_answer_every_question_but_whether_pairs_touch_which_fcl_decides_for_brute_force():
    assert MethodName("fcl", "brute-force", "mesh", "collision").label == "fcl brute-force"
    assert MethodName("fcl", "brute-force", "mesh", "distance").label == "own brute-force"
    assert MethodName("fcl", "native", "mesh", "distance").label == "fcl"
