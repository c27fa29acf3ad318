"""Claims about ratios: paired by repeat, and beyond the noise."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from harness.measure.noise import Control
from harness.measure.verdicts import verdict_on
from tests.measure.verdict_rows import Row, expected, judged, table


def timed(**seconds: list[float]) -> list[dict[str, Any]]:
    return [{"algorithm": name, "run_seconds": values} for name, values in seconds.items()]


DRIFT = np.array([1.0, 3.0, 2.0, 7.0, 5.0])


def test_ratios_are_paired_by_repeat() -> None:
    runs = table(*timed(brute=list(2.0 * DRIFT), grid=list(DRIFT))).sample(frac=1, random_state=1)
    row = Row("run_seconds", ratio_to={"algorithm": "brute"}, at_most=0.5)
    verdict = judged(row, runs, "algorithm")
    assert verdict.verdict == "holds"
    assert verdict.statement == (
        "run_seconds at algorithm=grid is 0.500 times that for algorithm=brute (claimed at most 0.5)"
    )
    assert judged(Row("run_seconds", ratio_to={"algorithm": "grid"}, at_most=1.9), runs, "algorithm").verdict == "fails"


def test_repeats_without_a_partner_are_left_out() -> None:
    drift = np.array([1.0, 3.0, 2.0, 7.0, 5.0, 4.0, 6.0])
    runs = table(
        {"algorithm": "brute", "run_seconds": list(2.0 * drift), "lost": [0]},
        {"algorithm": "grid", "run_seconds": list(drift), "lost": [4]},
    )
    row = Row("run_seconds", ratio_to={"algorithm": "brute"}, at_most=0.6)
    verdict = judged(row, runs, "algorithm")
    assert (verdict.verdict, verdict.groups[0].n) == ("holds", 5)
    assert "2 of 14 runs have no result" in verdict.statement
    assert expected(row, runs, "algorithm").verdict == "fails"


@pytest.mark.parametrize("repeats", [1, 2, 3, 4])
def test_a_ratio_of_clocks_from_fewer_than_five_repeats_is_undecided(repeats: int) -> None:
    runs = table(*timed(brute=[2.0] * repeats, grid=[1.0] * repeats))
    verdict = judged(Row("run_seconds", ratio_to={"algorithm": "brute"}, at_most=0.6), runs, "algorithm")
    assert verdict.verdict == "undecided"
    assert "too few pairs of repeats to judge (fewer than 5)" in verdict.statement


def test_a_ratio_of_counts_needs_no_repeats() -> None:
    runs = table({"algorithm": "a", "pair_tests": [2.0]}, {"algorithm": "b", "pair_tests": [1.0]})
    row = Row("pair_tests", {"algorithm": "b"}, ratio_to={"algorithm": "a"}, at_most=0.6)
    assert judged(row, runs, "algorithm").verdict == "holds"


@pytest.mark.parametrize(
    ("controls", "outcome", "said"),
    [
        ({}, "undecided", "without a control to judge its noise by"),
        ({"run_seconds": Control((0.01,) * 5)}, "holds", "claimed at most 0.55"),
        ({"run_seconds": Control((math.log(1.2),) * 5)}, "undecided", "by less than the noise floor of 20 %"),
    ],
)
def test_a_ratio_of_clocks_keeps_the_noise_floor(controls: Mapping[str, Control], outcome: str, said: str) -> None:
    runs = table(*timed(brute=list(2.0 * DRIFT), grid=list(DRIFT)))
    row = Row("run_seconds", {"algorithm": "grid"}, ratio_to={"algorithm": "brute"}, at_most=0.55)
    verdict = verdict_on(row, runs, ["algorithm"], "claim", controls)
    assert verdict.verdict == outcome
    assert said in verdict.statement


def test_only_points_that_differ_just_there_are_compared_and_each_must_satisfy() -> None:
    runs = table(
        {"algorithm": "brute", "count": 10, "run_seconds": [1.0] * 5},
        {"algorithm": "brute", "count": 20, "run_seconds": [4.0] * 5},
        {"algorithm": "grid", "count": 10, "run_seconds": [2.0] * 5},
        {"algorithm": "grid", "count": 20, "run_seconds": [2.0] * 5},
        {"algorithm": "grid", "count": 9999, "run_seconds": [9.0] * 5},
    )
    row = Row("run_seconds", {"algorithm": "grid"}, at_most=1, ratio_to={"algorithm": "brute"})
    verdict = judged(row, runs, "algorithm", "count")
    assert [(group.parameters["count"], group.value, group.verdict) for group in verdict.groups] == [
        (10, 2.0, "fails"),
        (20, 0.5, "holds"),
    ]
    assert verdict.verdict == "fails"
    assert "at algorithm=grid, count=10 is 2 times that for algorithm=brute" in verdict.statement
    assert "1 of 2 points fail" in verdict.statement
    large = Row("run_seconds", {"count": 20}, at_most=1, ratio_to={"algorithm": "brute"})
    assert judged(large, runs, "algorithm", "count").verdict == "holds"


def test_a_ratio_over_a_leaf_compares_points_whose_other_lists_vary_with_it() -> None:
    runs = table(*({"count": count, "dt": 1 / count, "run_seconds": [float(count)] * 5} for count in (5, 10, 50)))
    verdict = judged(Row("run_seconds", ratio_to={"count": 5}, at_most=10), runs, "count", "dt")
    assert [group.value for group in verdict.groups] == [2.0, 10.0]
    assert verdict.verdict == "holds"


def test_a_ratio_to_a_derived_value_finds_the_point_that_has_it() -> None:
    runs = table(
        {"mesh": "a.ply", "faces": 1753, "run_seconds": [1.0] * 5},
        {"mesh": "b.ply", "faces": 17001, "run_seconds": [1.9] * 5},
    )
    row = Row("run_seconds", {"faces": 17001}, ratio_to={"faces": 1753}, at_most=2)
    assert judged(row, runs, "mesh").verdict == "holds"


def test_nothing_to_compare_with_is_undecided() -> None:
    verdict = judged(
        Row("run_seconds", ratio_to={"algorithm": "tree"}, at_most=1), table(*timed(grid=[1.0])), "algorithm"
    )
    assert (verdict.verdict, verdict.statement) == (
        "undecided",
        "nothing to compare run_seconds with for algorithm=tree",
    )


def test_a_ratio_of_nothing_to_nothing_is_undecided() -> None:
    runs = table({"algorithm": "a", "pair_hits": [0.0] * 5}, {"algorithm": "b", "pair_hits": [0.0] * 5})
    verdict = judged(Row("pair_hits", ratio_to={"algorithm": "a"}, at_most=1), runs, "algorithm")
    assert verdict.verdict == "undecided"
    assert verdict.groups[0].value is None
