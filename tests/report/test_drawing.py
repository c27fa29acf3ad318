"""Figures as SVG."""

import re
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.report.drawing import palette
from harness.report.drawing.exponents import Slope, draw_exponents
from harness.report.drawing.panels import Line, Panel, draw_panels


def panel(lines, **changes):
    return Panel("", "number of bodies", "pair_seconds, ms", tuple(lines), **changes)


def label_heights(svg, labels):
    found = {text: float(y) for y, text in re.findall(r'<text [^>]*?y="([-\d.]+)"[^>]*>([^<]*)</text>', svg)}
    return sorted(found[label] for label in labels)


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(st.lists(st.floats(1.0, 1000.0), min_size=2, max_size=12))
def test_labels_at_line_ends_never_overlap(ends):
    labels = [f"series{place}" for place in range(len(ends))]
    lines = [
        Line(label, place, (1.0, 2.0), (1.0, end)) for place, (label, end) in enumerate(zip(labels, ends, strict=True))
    ]
    heights = label_heights(draw_panels([panel(lines)], "wide", "x"), labels)
    assert all(later - earlier > 15 for earlier, later in pairwise(heights))


def test_labels_that_fit_stand_at_their_lines():
    lines = [Line("low", 0, (1.0, 2.0), (1.0, 1.0)), Line("high", 1, (1.0, 2.0), (9.0, 9.0))]
    low, high = label_heights(draw_panels([panel(lines)], "wide", "x"), ["high", "low"])
    assert high - low > 100


def test_the_same_drawing_has_the_same_bytes():
    lines = [Line("a", 0, (1.0, 10.0), (1.0, 100.0), (0.9, 90.0), (1.1, 110.0))]
    first, second = (draw_panels([panel(lines, logarithmic=True)], "wide", "x") for _ in range(2))
    assert first == second


def test_no_colour_is_left_that_means_nothing():
    lines = [Line(str(place), place, (1.0, 2.0), (1.0, 2.0), foreign=place == 3) for place in range(7)]
    svg = draw_panels([panel(lines)], "wide", "x") + draw_exponents(
        [Slope("a", 0, 1.0, 0.9, 1.1)], "count", "wide", "y"
    )
    for text in (palette.themed(svg), palette.fixed(svg)):
        assert "#0102" not in text
    assert set(re.findall(r"#[0-9a-f]{6}\b", palette.themed(svg))) == set()


def test_text_stays_text_and_is_escaped():
    svg = draw_panels([panel([Line("<b>&", 0, (1.0, 2.0), (1.0, 2.0))])], "wide", "x")
    assert "&lt;b&gt;&amp;" in svg
    assert "<b>" not in svg


def test_a_lone_point_a_constant_and_an_exact_slope_can_be_drawn():
    for lines in ([Line("a", 0, (5.0,), (3.0,), (3.0,), (3.0,))], [Line("a", 0, (1.0, 2.0), (0.0, 0.0))]):
        for form in ("wide", "narrow", "card"):
            assert "<svg" in draw_panels([panel(lines)], form, "x")
    assert "<svg" in draw_exponents([Slope("a", 0, 0.0, float("nan"), float("nan"))], "count", "narrow", "x")


def test_series_are_told_apart_by_colour_or_marker_up_to_24():
    assert len({(palette.colour(style), palette.marker(style)) for style in range(24)}) == 24
