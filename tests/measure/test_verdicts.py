"""Expectations hold in every run, claims by the interval of the median, and what cannot be told is undecided."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
import pytest

from harness.measure.noise import Control
from harness.measure.verdicts import Kind, Verdict, expected_refusals, judge


@dataclass(frozen=True)
class Within:
    of: float
    relative: float


@dataclass(frozen=True)
class Row:
    """A criterion as an experiment file declares it."""

    metric: str
    where: Mapping[str, Any] = field(default_factory=dict)
    at_most: float | None = None
    at_least: float | None = None
    equals: float | None = None
    between: tuple[float, float] | None = None
    within: Within | None = None
    exponent_of: str | None = None
    ratio_to: Mapping[str, Any] | None = None


def table(*points: Mapping[str, Any]) -> pd.DataFrame:
    """A run table: points with leaves and, for each metric, a list with a value a repeat; "lost" are failed ones."""
    rows = []
    for number, point in enumerate(points):
        leaves = {name: value for name, value in point.items() if not isinstance(value, list)}
        metrics = {name: value for name, value in point.items() if isinstance(value, list) and name != "lost"}
        for repeat in range(max(map(len, metrics.values()))):
            ok = repeat not in point.get("lost", ())
            rows.append(
                {"experiment": "e", "point": f"p{number}", "repeat": repeat, "status": "ok" if ok else "timeout"}
                | {"reason": None if ok else "exceeded 120 s", "sweep": 1, "timing_grade": True}
                | leaves
                | {name: values[repeat] if ok else math.nan for name, values in metrics.items()}
            )
    made: pd.DataFrame = pd.DataFrame(rows)
    return made


def judged(row: Row, runs: pd.DataFrame, *swept: str, kind: Kind = "claim") -> Verdict:
    verdict = judge(row, runs, swept, kind)
    json.dumps(verdict.detail, allow_nan=False)
    assert verdict.statement
    return verdict


def expected(row: Row, runs: pd.DataFrame, *swept: str) -> Verdict:
    return judged(row, runs, *swept, kind="expectation")


def counted(power: float, counts: Sequence[int] = (5, 10, 20, 40), **leaves: Any) -> list[dict[str, Any]]:
    return [{"count": count, **leaves, "pair_tests": [3.0 * count**power] * 2} for count in counts]


# Expectations


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


def test_an_exact_power_has_an_exact_exponent() -> None:
    verdict = judged(Row("pair_tests", exponent_of="count", between=(2, 2)), table(*counted(2.0)), "count")
    assert verdict.verdict == "holds"
    assert verdict.statement == "pair_tests grows as count^2.00 [2.00, 2.00] (claimed between 2 and 2)"


@pytest.mark.parametrize(
    ("between", "outcome"), [((1.8, 2.2), "holds"), ((2.08, 2.2), "undecided"), ((0.8, 1.2), "fails")]
)
def test_an_exponent_is_judged_by_its_interval(between: tuple[float, float], outcome: str) -> None:
    pairs = [{"count": count, "pair_tests": [count * (count - 1) / 2]} for count in range(5, 55, 5)]
    verdict = judged(Row("pair_tests", exponent_of="count", between=between), table(*pairs), "count")
    assert verdict.verdict == outcome
    (group,) = verdict.groups
    assert (group.n, round(group.value or 0, 2)) == (10, 2.08)
    assert "pair_tests grows as count^2.08 [2.06, 2.10]" in verdict.statement


def test_every_combination_of_the_other_leaves_is_fitted_by_itself() -> None:
    runs = table(*counted(2.0, algorithm="brute-force"), *counted(1.0, algorithm="grid"))
    row = Row("pair_tests", exponent_of="count", between=(1.8, 2.2))
    verdict = judged(row, runs, "count", "algorithm")
    assert verdict.verdict == "fails"
    assert [(group.parameters["algorithm"], group.verdict) for group in verdict.groups] == [
        ("brute-force", "holds"),
        ("grid", "fails"),
    ]
    assert verdict.statement == (
        "pair_tests at algorithm=grid grows as count^1.00 [1.00, 1.00] (claimed between 1.8 and 2.2); "
        "1 of 2 groups fail"
    )
    one = Row("pair_tests", {"algorithm": "brute-force"}, exponent_of="count", between=(1.8, 2.2))
    assert "for algorithm=brute-force (claimed" in judged(one, runs, "count", "algorithm").statement


def test_leaves_that_vary_together_with_it_do_not_split_a_fit() -> None:
    zipped = [point | {"dt": 1 / (60 if point["count"] < 20 else 120)} for point in counted(2.0)]
    row = Row("pair_tests", exponent_of="count", between=(1.9, 2.1))
    assert len(judged(row, table(*zipped), "count", "dt").groups) == 1


def test_methods_that_ran_at_different_values_are_not_fitted_as_one() -> None:
    runs = table(*counted(2.0, (5, 10), algorithm="brute-force"), *counted(1.0, (20, 40), algorithm="grid"))
    verdict = judged(Row("pair_tests", exponent_of="count", between=(0, 3)), runs, "count", "algorithm")
    assert [group.verdict for group in verdict.groups] == ["undecided", "undecided"]


def test_growth_with_a_derived_value_pools_what_settles_it() -> None:
    meshes = {"a.ply": 1000, "b.ply": 4000, "c.ply": 9000}
    runs = table(
        *(
            {"mesh": mesh, "faces": faces, "count": count, "pair_tests": [float(faces * count)]}
            for mesh, faces in meshes.items()
            for count in (5, 50)
        )
    )
    verdict = judged(Row("pair_tests", exponent_of="faces", between=(0.9, 1.1)), runs, "mesh", "count")
    assert [(group.parameters, group.verdict) for group in verdict.groups] == [
        ({"count": 5}, "holds"),
        ({"count": 50}, "holds"),
    ]


def test_too_little_range_is_undecided() -> None:
    verdict = judged(Row("pair_tests", exponent_of="count", between=(1, 3)), table(*counted(2.0, (5, 10, 20))), "count")
    assert verdict.verdict == "undecided"
    assert "not enough range (3 points, a factor of 4)" in verdict.statement
    single = judged(Row("pair_tests", exponent_of="count", between=(1, 3)), table(*counted(2.0, (5,))), "count")
    assert single.verdict == "undecided"
    names = table(*({"mesh": mesh, "m": [1.0]} for mesh in "abc"))
    assert judged(Row("m", exponent_of="mesh", between=(1, 3)), names, "mesh").verdict == "undecided"
    assert judged(Row("m", exponent_of="faces", between=(1, 3)), names, "mesh").verdict == "undecided"


def test_zeros_are_left_out_of_a_fit_and_said() -> None:
    points = [{"count": 1, "pair_tests": [0.0]}, *counted(1.0)]
    verdict = judged(Row("pair_tests", exponent_of="count", between=(0.9, 1.1)), table(*points), "count")
    assert verdict.verdict == "holds"
    assert "without count=1 as not above 0" in verdict.statement


def test_an_expected_exponent_fails_when_runs_failed() -> None:
    runs = table(*counted(2.0), {"count": 80, "pair_tests": [1.0], "lost": [0]})
    row = Row("pair_tests", exponent_of="count", between=(1.9, 2.1))
    assert judged(row, runs, "count").verdict == "holds"
    assert expected(row, runs, "count").verdict == "fails"


# Ratios


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
    verdict = judge(row, runs, ["algorithm"], "claim", controls)
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
