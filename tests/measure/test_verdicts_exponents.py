"""Claims about exponents: fitted where enough is known, undecided where not."""

from __future__ import annotations

import pytest

from tests.measure.verdict_rows import Row, counted, expected, judged, table


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
