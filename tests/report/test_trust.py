"""The rates that the page shows: they are what the program says now, and small enough."""

import pytest

from harness.report.trust.rates import Rate, simulated, stored

STORED = {rate.what: rate for rate in stored()}
LINES = {line.what: line for line in simulated()}


def test_every_line_has_its_rate():
    assert list(STORED) == list(LINES)


@pytest.mark.slow
@pytest.mark.parametrize("what", list(LINES))
def test_a_short_form_made_anew_is_compatible_with_what_is_stored(what):
    """The first trials are the same ones, so what came out in them is no more than what came out in all."""
    line, kept = LINES[what], STORED[what]
    again = line.rate(max(1, line.trials // 60))
    assert (again.kind, again.wanted) == (kept.kind, kept.wanted)
    assert again.times <= kept.times
    assert again.trials - again.times <= kept.trials - kept.times


@pytest.mark.parametrize("rate", [rate for rate in STORED.values() if rate.wanted == "under 5 %"], ids=lambda r: r.what)
def test_fewer_than_five_in_a_hundred_are_false(rate):
    assert rate.share < 0.05
    assert rate.trials >= 30


@pytest.mark.parametrize("rate", [rate for rate in STORED.values() if rate.kind == "Exponents"], ids=lambda r: r.what)
def test_an_interval_of_an_exponent_is_one_of_95_in_100(rate):
    assert rate.share < 0.06


def test_real_differences_are_still_found():
    assert STORED["a method 2 times as fast, five repeats, is named"].share > 0.95
    assert STORED["the noisiest of twelve points, 2.0 times as slow, 5 repeats, is called slower"].share > 0.5


def test_no_failure_in_sixty_allows_a_rate_of_nearly_five_percent():
    assert Rate("", "", "", 0, 60).most == pytest.approx(1 - 0.05 ** (1 / 60))
