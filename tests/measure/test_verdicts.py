"""Expectations hold in every run, claims by the interval of the median, and what cannot be told is undecided."""

from __future__ import annotations

import math
from typing import Any

import pytest

from harness.measure.verdicts import expected_refusals
from tests.measure.verdict_rows import Row, Within, expected, judged, table

DRIFTS = table({"count": 5, "energy_drift": [0.0, 2e-13]}, {"count": 50, "energy_drift": [1e-13, 3e-9]})


def test_an_expectation_holds_when_every_run_does_and_tells_the_one_with_the_least_to_spare() -> None:
    verdict = expected(Row("energy_drift", at_most=1e-8), DRIFTS, "count")
    assert verdict.verdict == "holds"
    assert verdict.statement == (
        "energy_drift at count=50, repeat=1 is 3.00e-09 (expected at most 1e-08); "
        "2 of 2 points hold, this one with the least to spare"
    )


def test_one_run_breaks_an_expectation_and_is_named() -> None:
    verdict = expected(Row("energy_drift", at_most=1e-12), DRIFTS, "count")
    assert verdict.verdict == "fails"
    assert verdict.statement == (
        "energy_drift at count=50, repeat=1 is 3.00e-09 (expected at most 1e-12); 1 of 2 points fail"
    )
    assert [group.verdict for group in verdict.groups] == ["holds", "fails"]
    assert verdict.groups[1].parameters == {"count": 50}


@pytest.mark.parametrize(
    ("row", "outcome"),
    [
        (Row("m", at_most=3), "holds"),
        (Row("m", at_most=2.999), "fails"),
        (Row("m", at_least=1), "holds"),
        (Row("m", at_least=1.001), "fails"),
        (Row("m", between=(1, 3)), "holds"),
        (Row("m", between=(1.5, 3)), "fails"),
        (Row("m", within=Within(2, 0.5)), "holds"),
        (Row("m", within=Within(2, 0.49)), "fails"),
        (Row("m", within=Within(-2, 0.5)), "fails"),
        (Row("m", equals=2), "fails"),
    ],
)
def test_limits_are_inclusive_for_every_run(row: Row, outcome: str) -> None:
    assert expected(row, table({"m": [1.0, 2.0, 3.0]})).verdict == outcome


def test_equals_allows_for_rounding_and_for_nothing_else() -> None:
    assert expected(Row("m", equals=0.3), table({"m": [0.1 + 0.2]})).verdict == "holds"
    assert expected(Row("m", equals=735000), table({"m": [735001.0]})).verdict == "fails"
    assert expected(Row("m", equals=0), table({"m": [0.0]})).verdict == "holds"
    assert expected(Row("m", equals=0), table({"m": [1e-300]})).verdict == "fails"


def test_what_is_not_a_number_or_not_reported_breaks_an_expectation() -> None:
    runs = table({"count": 5, "m": [1.0, 1.0]}, {"count": 6, "m": [1.0, math.nan]})
    verdict = expected(Row("m", at_most=2), runs, "count")
    assert verdict.verdict == "fails"
    assert "1 of 4 runs report no m, or not a number (count=6, repeat=1)" in verdict.statement
    assert expected(Row("never_reported", at_most=2), runs, "count").verdict == "fails"
    assert expected(Row("m", at_most=2), table({"m": [math.inf]})).verdict == "fails"


def test_a_failed_run_breaks_an_expectation_that_speaks_of_it() -> None:
    runs = table({"count": 5, "m": [1.0, 1.0]}, {"count": 6, "m": [1.0, 1.0], "lost": [1]})
    verdict = expected(Row("m", at_most=2), runs, "count")
    assert verdict.verdict == "fails"
    assert verdict.statement.startswith("1 of 4 runs have no result (1 timeout; count=6, repeat=1: exceeded 120 s); ")
    assert expected(Row("m", {"count": 5}, at_most=2), runs, "count").verdict == "holds"
    every = table({"count": 6, "m": [1.0], "lost": [0]})
    assert expected(Row("m", at_most=2), every, "count").verdict == "fails"


def test_an_expectation_of_no_run_is_undecided() -> None:
    verdict = expected(Row("m", {"algorithm": "tree"}, at_most=2), table({"algorithm": "grid", "m": [1.0]}))
    assert (verdict.verdict, verdict.statement) == ("undecided", "no run for algorithm=tree to judge m by")
    assert expected(Row("m", {"colour": "red"}, at_most=2), table({"m": [1.0]})).verdict == "undecided"


# Claims about values


@pytest.mark.parametrize(("limit", "outcome"), [(1.2, "holds"), (1.1, "undecided"), (0.8, "fails")])
def test_a_claim_is_judged_by_the_interval_of_the_median(limit: float, outcome: str) -> None:
    runs = table({"pair_seconds": [0.9, 1.0, 1.05, 1.1, 1.15]})
    verdict = judged(Row("pair_seconds", at_most=limit), runs)
    assert verdict.verdict == outcome
    assert verdict.statement.startswith("pair_seconds is 1.05 [0.900, 1.15]")
    assert f"(claimed at most {limit})" in verdict.statement


def test_few_repeats_of_a_clock_have_a_range_and_one_says_nothing() -> None:
    assert (
        "1 (range of 3 repeats: [0.900, 1.10])"
        in judged(Row("pair_seconds", at_most=2), table({"pair_seconds": [1.0, 0.9, 1.1]})).statement
    )
    assert judged(Row("pair_seconds", at_most=2), table({"pair_seconds": [1.0]})).verdict == "undecided"
    assert judged(Row("pair_tests", at_most=2), table({"pair_tests": [1.0]})).verdict == "holds"


def test_failed_runs_are_left_out_of_a_claim_and_said() -> None:
    runs = table({"m": [1.0, 1.0, 9.0, 1.0], "lost": [2]})
    verdict = judged(Row("m", at_most=2), runs)
    assert verdict.verdict == "holds"
    assert "1 of 4 runs have no result (1 timeout; repeat=2: exceeded 120 s)" in verdict.statement


def test_a_point_without_any_result_leaves_a_claim_undecided_and_another_can_still_break_it() -> None:
    runs = table({"count": 1, "m": [1.0]}, {"count": 2, "m": [1.0], "lost": [0]}, {"count": 3, "m": [5.0, 5.0]})
    assert judged(Row("m", {"count": [2, 3]}, at_most=9), runs, "count").verdict == "undecided"
    assert judged(Row("m", at_most=2), runs, "count").verdict == "fails"


# Which runs


@pytest.mark.parametrize(
    ("where", "counts"),
    [
        ({"count": 10.0}, [10]),
        ({"dt": 1 / 60}, [5]),
        ({"count": [5, 20]}, [5, 20]),
        ({"mesh": None}, [5]),
        ({"size": {"uniform": [0.5, 1.5]}}, [10]),
        ({"box": [1.0, 2.0, 3.0]}, [20]),
        ({"count": "10"}, []),
        ({"count": True}, []),
        ({"count": 10, "mesh": "duck.obj"}, [10]),
    ],
)
def test_where_chooses_by_value(where: dict[str, Any], counts: list[int]) -> None:
    runs = table(
        {"count": 5, "dt": 0.016666666666666667, "mesh": None, "size": "1.0", "box": None, "m": [1.0]},
        {"count": 10, "dt": 0.1, "mesh": "duck.obj", "size": '{"uniform": [0.5, 1.5]}', "box": None, "m": [1.0]},
        {"count": 20, "dt": 0.2, "mesh": "duck.obj", "size": "1.0", "box": "[1.0, 2.0, 3.0]", "m": [1.0]},
        {"count": 40, "dt": 0.2, "mesh": "duck.obj", "size": "1.0", "box": "[9.0, 2.0, 3.0]", "m": [9.0]},
    )
    verdict = expected(Row("m", where, at_most=2), runs, "count")
    assert len(verdict.groups) == len(counts)
    if len(counts) > 1:
        assert [group.parameters["count"] for group in verdict.groups] == counts


# Exponents


def test_a_refusal_is_expected_by_its_own_metric_and_breaks_every_other() -> None:
    runs = table({"count": 5, "escaped": [0.0]}, {"count": 500, "escaped": [0.0]})
    runs.loc[runs["count"] == 500, ["status", "reason", "escaped"]] = ["rejected", "too dense", math.nan]
    expected = Row("rejected", {"count": 500}, equals=1.0)
    assert judged(expected, runs, "count", kind="expectation").verdict == "holds"
    assert judged(Row("rejected", {"count": 5}, equals=1.0), runs, "count", kind="expectation").verdict == "fails"
    assert judged(Row("rejected", {"count": 5}, equals=0.0), runs, "count", kind="expectation").verdict == "holds"
    assert judged(Row("escaped", equals=0.0), runs, "count", kind="expectation").verdict == "fails"
    assert expected_refusals([Row("escaped", equals=0.0), expected], runs) == {("p1", 0)}
    assert expected_refusals([Row("rejected", equals=0.0)], runs) == set()
    assert (runs["status"] == "rejected").sum() == 1


def test_a_crash_is_no_refusal() -> None:
    runs = table({"count": 5, "escaped": [0.0], "lost": [0]})
    assert judged(Row("rejected", equals=1.0), runs, kind="expectation").verdict == "fails"
    assert expected_refusals([Row("rejected", equals=1.0)], runs) == set()
