"""Figures as SVG."""

import re
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.report.drawing import palette
from harness.report.drawing.exponents import Slope, draw_exponents
from harness.report.drawing.panels import Line, Panel, draw_panels
from harness.report.lines import spans_wide
from harness.report.styles import style_of
from harness.vocabulary import ALGORITHMS, MethodName


def panel(lines, **changes):
    return Panel("", "number of bodies", "pair_seconds, ms", tuple(lines), **changes)


def label_heights(svg, labels):
    found = {text: float(y) for y, text in re.findall(r'<text [^>]*?y="([-\d.]+)"[^>]*>([^<]*)</text>', svg)}
    return sorted(found[label] for label in labels)


def drawn_line(svg):
    """The points of the line of series 0, px."""
    path = re.search(r'<path d="M([\d. L]+)" fill="none" stroke="#0102f0" stroke-width="2"', svg)[1]
    points = [tuple(map(float, point.split())) for point in path.split("L")]
    return [x for x, _ in points], [y for _, y in points]


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


@pytest.mark.parametrize("form", ["wide", "narrow", "card"])
def test_texts_of_the_axis_below_stay_on_the_drawing(form):
    """A long name of x takes two lines, and the last value has room for half of its text."""
    name = "packing (volume of spheres / volume of box) (packing)"
    long = Panel("", name, "y", (Line("a", 0, (1.0, 1e12), (1.0, 2.0)),))
    svg = draw_panels([long], form, "x")
    width = float(re.search(r'viewBox="0 0 (\d+)', svg)[1])
    below = re.findall(r'<text x="([\d.]+)"[^>]*text-anchor="middle"[^>]*>([^<]*)</text>', svg)
    assert any(text.startswith("1\u202f000") for _, text in below)
    for x, text in below:
        half = (5.5 if form == "card" else 6.5) * len(text) / 2  # px of an average letter
        assert half <= float(x) <= width - half, text
    words = " ".join(text for _, text in below if text[0].isalpha() or text[0] == "(")
    assert words == ("" if form == "card" else name)


def test_labels_that_fit_stand_at_their_lines():
    lines = [Line("low", 0, (1.0, 2.0), (1.0, 1.0)), Line("high", 1, (1.0, 2.0), (9.0, 9.0))]
    low, high = label_heights(draw_panels([panel(lines)], "wide", "x"), ["high", "low"])
    assert high - low > 100


def test_an_axis_below_is_logarithmic_where_x_spans_much_and_y_little():
    """The values of x stand at even steps, those of y where they did."""
    lines = [Line("a", 0, (1e3, 1e4, 1e5, 1e6), (16.0, 20.0, 22.0, 21.0))]
    assert spans_wide(panel(lines))
    assert not spans_wide(panel([Line("a", 0, (1.0, 20.0), (1.0, 2.0))]))
    assert not spans_wide(panel([Line("a", 0, (0.0, 1e3), (1.0, 2.0))]))
    evenly, even_y = drawn_line(draw_panels([panel(lines, logarithmic_x=True)], "wide", "x"))
    crowded, y = drawn_line(draw_panels([panel(lines)], "wide", "x"))
    assert np.allclose(np.diff(evenly), np.diff(evenly)[0], atol=0.1)
    assert crowded[2] - crowded[0] < 0.2 * (crowded[3] - crowded[0])
    assert even_y == y


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


# What linear red, green and blue become to those who lack one kind of cone: Machado, Oliveira and Fernandes, 2009.
BLIND = {
    "nobody": np.eye(3),
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def lab(colour, matrix):
    """A colour as it is seen, in CIELAB (D65)."""
    values = np.array([int(colour[at : at + 2], 16) for at in (1, 3, 5)]) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    seen = np.clip(np.asarray(matrix) @ linear, 0, 1)
    white = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) / [
        [0.9505],
        [1.0],
        [1.089],
    ]
    x, y, z = np.cbrt(white @ seen)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("colours", [palette.LIGHT, palette.DARK])
@pytest.mark.parametrize("matrix", BLIND.values(), ids=list(BLIND))
def test_colours_are_told_apart_by_the_colour_blind(colours, matrix):
    seen = [lab(colour, matrix) for colour in colours]
    # a just noticeable one is 2.3
    for count, least in ((6, 25), (len(colours), 20)):
        assert min(np.linalg.norm(one - other) for one, other in combinations(seen[:count], 2)) > least


def test_no_two_methods_of_the_default_sweep_share_a_colour():
    own = [f"fcl/{name}" for name, word in ALGORITHMS.items() if word.own]
    names = [*own, "fcl/native", "pybullet", "coal", "mujoco", "trimesh", "rapier3d"]
    styles = [style_of(MethodName.read(name, "hull", "distance")) for name in names]
    assert len({palette.colour(style) for style in styles}) == len(names) == len(palette.LIGHT)
