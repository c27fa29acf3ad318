"""Numbers as people read them."""

import math

from hypothesis import given
from hypothesis import strategies as st

from harness.report.quantity import MISSING, leaf_text, number, plural, quantity, scale
from harness.report.words import leaf_label


def test_three_digits_and_thousands_apart():
    assert [number(value) for value in (0.0123456, 1.5, 24.71, 188404, -3.14159)] == [
        "0.0123", "1.50", "24.7", "188\u202f404", "−3.14",
    ]  # fmt: skip


def test_powers_of_ten_only_far_from_one():
    assert number(2.22e-16) == "2.22\u202f×\u202f10⁻¹⁶"
    assert number(0.0) == "0"


def test_what_is_no_number_is_said():
    assert number(math.nan) == quantity(math.nan, "s") == quantity(None, "s") == MISSING
    assert number(math.inf) == "∞"


def test_a_unit_takes_the_prefix_that_suits_it():
    assert quantity(0.00345, "s") == "3.45\u00a0ms"
    assert quantity(3.1e-5, "s") == "31.0\u00a0µs"
    assert quantity(90_000_000, "B") == "90\u00a0MB"
    assert quantity(12.5, "1") == "12.5"


def test_a_column_has_one_unit_and_it_suits_its_middle():
    column = scale([2e-6, 3.1e-3, 5e-3, 1.0], "s")
    assert column.symbol == "ms"
    assert [column.text(value) for value in (2e-6, 3.1e-3, 1.0)] == ["0.00200", "3.10", "1\u202f000"]


def test_a_margin_has_the_decimals_of_its_value():
    column = scale([0.0247], "s")
    assert (column.text(0.0247), column.margin(0.0247, 0.00041)) == ("24.7", "0.4")


def test_leaves_read_as_their_author_wrote_them():
    assert leaf_text(1 / 60) == "1/60"
    assert [leaf_text(value) for value in (0.25, 0.01, 1e-6, 1000)] == ["0.25", "0.01", "10⁻⁶", "1\u202f000"]
    assert leaf_text({"uniform": [0.5, 1.5]}) == "uniform 0.5 to 1.5"
    assert (leaf_text(None), leaf_text(True)) == ("none", "yes")


def test_one_run_is_no_runs():
    assert (plural(1, "run"), plural(2, "run")) == ("1\u00a0run", "2\u00a0runs")


@given(st.floats(allow_nan=True, allow_infinity=True))
def test_every_number_has_a_text(value):
    assert number(value)
    assert leaf_text(value)
    assert quantity(value, "s")


def test_forced_stages_are_told_as_they_are_written():
    assert leaf_label("stages", {}) == "as planned"
    assert leaf_label("stages", {"hull_axis": False, "orientations": True}) == "hull_axis off, orientations on"
