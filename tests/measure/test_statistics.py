"""Medians, intervals, ratios and exponents: what they are whatever the values, and intervals cover what they say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from harness.measure.statistics import NOISY_ABOVE, fit_exponent, geometric_mean, paired_ratio, summary

positive = st.floats(1e-6, 1e6)
finite = st.integers(-(10**9), 10**9).map(lambda number: number / 1024)  # no underflow when scaled
scales = st.integers(-20, 20).map(lambda power: 2.0**power)  # exact in floating point


def test_five_repeats_have_the_range_with_the_coverage_it_really_has() -> None:
    found = summary([3.0, 1.0, 2.0, 5.0, 4.0])
    assert (found.median, found.low, found.high, found.n) == (3.0, 1.0, 5.0, 5)
    assert found.coverage == pytest.approx(0.9375)


@pytest.mark.parametrize("n", range(1, 5))
def test_fewer_than_five_repeats_have_a_range_and_no_coverage(n: int) -> None:
    found = summary(np.arange(1.0, n + 1))
    assert (found.low, found.high, found.coverage, found.precise) == (1.0, float(n), None, None)


def at_most(place: int, n: int) -> float:
    """The chance that of n throws of a coin at most so many are heads."""
    return sum(math.comb(n, heads) for heads in range(place + 1)) / 2**n


@pytest.mark.parametrize("n", range(6, 60))
def test_more_repeats_have_the_narrowest_symmetric_pair_that_covers_95_in_100(n: int) -> None:
    found = summary(np.arange(n))
    place = int(found.low)
    assert found.high == n - 1 - place
    assert found.coverage == pytest.approx(1 - 2 * at_most(place, n))
    assert found.coverage is not None
    assert found.coverage >= 0.95
    assert 1 - 2 * at_most(place + 1, n) < 0.95


@pytest.mark.parametrize("n", [5, 9, 20])
def test_intervals_cover_the_median_as_often_as_they_say(n: int) -> None:
    random = np.random.default_rng(259)
    found = [summary(sample) for sample in random.lognormal(size=(2000, n))]  # true median 1
    covered = np.mean([one.low <= 1.0 <= one.high for one in found])
    assert covered == pytest.approx(found[0].coverage, abs=0.02)


@given(st.lists(finite, min_size=1, max_size=30), scales, st.randoms())
def test_a_summary_knows_neither_unit_nor_order(values: list[float], scale: float, order: object) -> None:
    found = summary(values)
    scaled = summary([value * scale for value in values])
    assert (scaled.median, scaled.low, scaled.high) == (found.median * scale, found.low * scale, found.high * scale)
    assert scaled.outliers == found.outliers
    shuffled = values[:]
    order.shuffle(shuffled)  # type: ignore[attr-defined]
    assert (summary(shuffled).median, summary(shuffled).low, summary(shuffled).high) == (
        found.median,
        found.low,
        found.high,
    )


@given(st.lists(finite, min_size=1, max_size=40))
def test_the_interval_holds_the_median_and_lies_within_the_values(values: list[float]) -> None:
    found = summary(values)
    assert min(values) <= found.low <= found.median <= found.high <= max(values)


@given(st.lists(finite, min_size=1, max_size=20), st.integers(0, 20))
def test_what_is_not_a_number_is_counted_and_left_out(values: list[float], place: int) -> None:
    with_gap = [*values[:place], math.nan, *values[place:]]
    found, whole = summary(with_gap), summary(values)
    assert (found.median, found.low, found.high, found.n, found.missing) == (
        whole.median,
        whole.low,
        whole.high,
        len(values),
        1,
    )


def test_no_values_have_no_median() -> None:
    found = summary([math.nan])
    assert math.isnan(found.median)
    assert (found.n, found.missing, found.coverage) == (0, 1, None)


def test_outliers_are_flagged_where_they_stand_and_still_count() -> None:
    values = [1.00, 1.01, 9.0, 0.99, math.nan, 1.02]
    found = summary(values)
    assert found.outliers == (2,)
    assert (found.high, found.n) == (9.0, 5)
    assert summary([1.0, 1.0, 1.0, 1.0, 1.04]).outliers == ()  # too little to matter
    assert summary([1.0, 1.0, 1.0, 1.0, 1.06]).outliers == (4,)


def test_stable_means_half_an_interval_of_at_most_5_percent() -> None:
    assert NOISY_ABOVE == 0.05
    assert summary([0.96, 0.98, 1.0, 1.02, 1.04]).precise
    assert not summary([0.94, 0.98, 1.0, 1.02, 1.06]).precise
    assert summary([0.0] * 5).precise
    assert not summary([-1.0, 0.0, 0.0, 0.0, 1.0]).precise


def test_what_pairs_share_cancels() -> None:
    drift = np.array([1.0, 3.0, 2.0, 7.0, 5.0])
    found = paired_ratio(2.0 * drift, drift)
    assert (found.median, found.low, found.high, found.n) == (2.0, 2.0, 2.0, 5)


@given(st.lists(st.tuples(positive, positive), min_size=1, max_size=15).filter(lambda pairs: len(pairs) % 2 == 1))
def test_turning_pairs_over_turns_their_ratio_over(pairs: list[tuple[float, float]]) -> None:
    a, b = zip(*pairs, strict=True)
    forward, backward = paired_ratio(a, b), paired_ratio(b, a)
    assert forward.median == pytest.approx(1 / backward.median)
    assert (forward.low, forward.high) == pytest.approx((1 / backward.high, 1 / backward.low))


@given(st.lists(st.tuples(positive, positive), min_size=1, max_size=15), st.randoms())
def test_the_order_of_pairs_does_not_matter_but_the_pairing_does(
    pairs: list[tuple[float, float]], order: object
) -> None:
    shuffled = pairs[:]
    order.shuffle(shuffled)  # type: ignore[attr-defined]
    found, again = paired_ratio(*zip(*pairs, strict=True)), paired_ratio(*zip(*shuffled, strict=True))
    assert (found.median, found.low, found.high) == (again.median, again.low, again.high)
    assert (
        paired_ratio([1.0, 2.0, 3.0], [3.0, 1.0, 2.0]).median != paired_ratio([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]).median
    )


def test_pairs_without_a_ratio_are_missing_and_unequal_lengths_are_refused() -> None:
    found = paired_ratio([1.0, 0.0, math.nan, 4.0], [0.0, 0.0, 1.0, 2.0])
    assert (found.n, found.missing, found.low, found.high) == (2, 2, 2.0, math.inf)
    with pytest.raises(ValueError, match="3 values cannot be paired with 2"):
        paired_ratio([1, 2, 3], [1, 2])


@given(
    st.floats(-3, 3),
    st.floats(1e-3, 1e3),
    st.lists(st.floats(1e-2, 1e4), min_size=3, max_size=8, unique_by=lambda x: round(math.log(x), 2)),
)
def test_an_exact_power_law_has_its_exponent_and_an_interval_without_width(
    power: float, factor: float, xs: list[float]
) -> None:
    assume(max(xs) / min(xs) >= 1.5)
    found = fit_exponent({x: [factor * x**power] for x in xs})
    assert found.value == pytest.approx(power, abs=1e-7)
    assert found.high - found.low < 1e-5
    assert found.r2 == pytest.approx(1.0) or abs(power) < 1e-6
    assert found.enough == (max(xs) / min(xs) >= 8 * (1 - 1e-9))


@given(
    st.dictionaries(st.integers(1, 100).map(float), st.lists(positive, min_size=1, max_size=5), min_size=3, max_size=8),
    scales,
    scales,
)
def test_an_exponent_knows_no_units(samples: dict[float, list[float]], x_scale: float, y_scale: float) -> None:
    found = fit_exponent(samples)
    scaled = fit_exponent({x * x_scale: [y * y_scale for y in ys] for x, ys in samples.items()})
    assert (scaled.value, scaled.low, scaled.high) == pytest.approx(
        (found.value, found.low, found.high), rel=1e-6, abs=1e-6
    )


@pytest.mark.slow
def test_exponents_cover_the_truth_95_times_in_100() -> None:
    random = np.random.default_rng(259)
    xs = np.geomspace(5, 50, 10)
    covered = 0
    for _ in range(1000):
        found = fit_exponent({x: x**1.5 * random.lognormal(sigma=0.1, size=5) for x in xs})
        covered += found.low <= 1.5 <= found.high
    assert covered / 1000 == pytest.approx(0.95, abs=0.03)


def test_pairs_of_a_number_grow_with_nearly_its_square() -> None:
    found = fit_exponent({n: [n * (n - 1) / 2] for n in range(5, 55, 5)})
    assert found.low < found.value < found.high
    assert 2.0 < found.low < found.high < 2.15
    assert found.r2 > 0.999


def test_a_factor_of_eight_is_enough_and_less_is_not() -> None:
    assert fit_exponent({1: [1], 2: [2], 8: [8]}).enough
    assert not fit_exponent({1: [1], 2: [2], 7.9: [7.9]}).enough
    assert not fit_exponent({1: [1], 100: [100]}).enough
    assert fit_exponent({0.1: [1], 0.2: [2], 0.8: [8]}).enough  # 0.8 / 0.1 rounds


def test_what_has_no_logarithm_is_dropped_and_named() -> None:
    found = fit_exponent({0: [5], 1: [1], 2: [2], 4: [0, 0, 0], 8: [8], 16: [math.nan]})
    assert found.value == pytest.approx(1.0)
    assert (found.n, found.dropped) == (3, (0.0, 4.0))
    assert math.isnan(fit_exponent({}).value)
    assert math.isnan(fit_exponent({1: [1]}).value)
    assert math.isnan(fit_exponent({1: [1], 10: [10]}).low)


def test_what_does_not_grow_has_the_power_zero_and_is_wholly_explained() -> None:
    found = fit_exponent({1: [7], 4: [7], 16: [7]})
    assert (found.value, found.low, found.high, found.r2) == (0.0, 0.0, 0.0, 1.0)


@given(st.lists(positive, min_size=1, max_size=20))
def test_the_geometric_mean_of_ratios_turns_over_with_them(values: list[float]) -> None:
    assert geometric_mean(values) == pytest.approx(1 / geometric_mean([1 / value for value in values]))


@pytest.mark.parametrize("values", [[], [1.0, 0.0], [1.0, -1.0], [1.0, math.nan], [math.inf]])
def test_a_geometric_mean_needs_positive_numbers(values: list[float]) -> None:
    with pytest.raises(ValueError, match="above 0"):
        geometric_mean(values)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scales", "xs"),
    [
        ((0.2, 0.1, 0.05, 0.02, 0.01), (5, 10, 20, 40, 80)),  # short runs are noisier
        ((0.3, 0.01, 0.01, 0.01), (5, 10, 20, 40)),
        ((0.03, 0.03, 0.03), (5, 10, 50)),
        (tuple(np.geomspace(0.2, 0.01, 10)), tuple(range(5, 55, 5))),
    ],
)
@pytest.mark.parametrize("repeats", [5, 10])
def test_an_interval_of_an_exponent_covers_it_however_the_noise_is_spread(
    scales: tuple[float, ...], xs: tuple[int, ...], repeats: int
) -> None:
    rng = np.random.default_rng([repeats, len(xs)])
    held = []
    for _ in range(600):
        noise = rng.normal(0.0, 0.1, (repeats, 1)) + rng.normal(0.0, scales, (repeats, len(xs)))
        times = np.array(xs) ** 1.7 * np.exp(noise)
        found = fit_exponent({x: list(column) for x, column in zip(xs, times.T, strict=True)})
        held.append(found.low <= 1.7 <= found.high)
    assert np.mean(held) >= 0.93


def test_growth_that_is_no_power_law_has_the_interval_of_its_scatter() -> None:
    """x + 30 grows as 1.00 at large x and as 0.1 at small: no noise of repeats says so."""
    noise = np.array([1.0, 1.001, 0.999, 1.002, 0.998])
    curved = fit_exponent({x: list((x + 30) * noise) for x in (5, 10, 20, 40, 80)})
    assert curved.high - curved.low > 0.3
    straight = fit_exponent({x: list(x**1.5 * noise) for x in (5, 10, 20, 40, 80)})
    assert straight.high - straight.low < 0.01
