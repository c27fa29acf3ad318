"""A drawing's elements: what was drawn, where, and in which order, as a parser of XML reads them."""

import math
import xml.etree.ElementTree as ElementTree

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from matplotlib.markers import MarkerStyle
from matplotlib.ticker import MaxNLocator

from harness.report.drawing import palette
from harness.report.drawing.axes import even_numbers
from harness.report.drawing.canvas import Canvas
from harness.report.drawing.markers import outline
from tests.conftest import examples


def drawn(canvas, name="x"):
    return list(ElementTree.fromstring(canvas.svg(name)))


def numbers(path):
    return [float(word) for word in path.replace("M", " ").replace("L", " ").replace("z", " ").split()]


def test_areas_lie_behind_lines_and_lines_behind_texts():
    canvas = Canvas(100, 50, 13)
    canvas.text(1, 2, "a")
    canvas.line([0, 10], [0, 10], palette.INK, 1.0)
    canvas.area([0, 1, 1], [0, 0, 1], palette.SOFT)
    kinds = [(element.tag, element.get("fill")) for element in drawn(canvas)]
    assert kinds == [("path", palette.SOFT), ("path", "none"), ("text", palette.INK)]


def test_y_grows_upwards_and_nan_interrupts_a_line():
    canvas = Canvas(100, 50, 13)
    canvas.line([1, 2, math.nan, 3, 4], [5, 6, math.nan, 7, 8], palette.INK, 2.0, dashes=(1, 3))
    (line,) = drawn(canvas)
    assert line.get("d") == "M1 45L2 44M3 43L4 42"
    assert line.get("stroke-dasharray") == "2,6"  # in widths of the line


def test_markers_stand_at_every_point_and_each_kind_is_defined_once():
    canvas = Canvas(100, 50, 13)
    for colour in palette.SERIES[:2]:
        canvas.line([1, math.nan, 3], [5, 6, 7], colour, 0.0, marker="o", size=6)
    canvas.line([1], [5], palette.INK, 0.0, marker="s", size=6, hollow=True)
    defined, *groups = drawn(canvas)
    identities = [path.get("id") for path in defined]
    assert len(set(identities)) == len(identities) == 2
    assert [len(group) for group in groups] == [2, 2, 1]
    assert [use.get("href") for group in groups for use in group] == [f"#{identities[0]}"] * 4 + [f"#{identities[1]}"]
    assert [group.get("fill") for group in groups] == [*palette.SERIES[:2], palette.PAGE]
    assert {path.get("id") for path in drawn(canvas, "y")[0]}.isdisjoint(identities)  # two drawings on one page


def test_what_cannot_be_placed_leaves_no_element():
    canvas = Canvas(100, 50, 13)
    canvas.line([math.nan], [1.0], palette.INK, 1.0)
    canvas.text(1, 2, "")
    assert drawn(canvas) == []


def test_a_turned_text_reads_upwards_about_its_anchor():
    canvas = Canvas(100, 50, 10)
    canvas.text(20, 30, "<up>", horizontal="center", vertical="center", turned=True)
    (text,) = drawn(canvas)
    assert text.get("transform") == "translate(22.6 20)rotate(-90)"
    assert (text.get("text-anchor"), text.text) == ("middle", "<up>")


@pytest.mark.parametrize("marker", [*palette.MARKERS, "|"])
def test_markers_are_as_large_as_matplotlib_draws_them(marker):
    style = MarkerStyle(marker)
    box = style.get_transform().transform_path(style.get_path()).get_extents()
    if marker == "o":
        assert outline("o", 4.0) == "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z"
        return
    places = numbers(outline(marker, 50.0))
    xs, ys = places[::2], places[1::2]
    found = [min(xs), max(xs), -max(ys), -min(ys)]
    assert found == pytest.approx([100 * edge for edge in (box.x0, box.x1, box.y0, box.y1)], abs=0.01)


@settings(max_examples=examples(200), deadline=None)
@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(3, 7), st.sampled_from([(1, 2, 2.5, 5), (1, 2, 5)]))
def test_even_numbers_are_those_of_matplotlib(low, span, most, steps):
    high = low + span
    # whether a number on a bound is within it hangs on the last digit, and on it how many there are
    tried = [step * 10.0**power for power in range(-6, 7) for step in steps if step * 10.0**power <= span]
    assume(all(abs(bound / step - round(bound / step)) > 1e-6 for bound in (low, high) for step in tried[-12:]))
    theirs = [float(value) for value in MaxNLocator(most, steps=[*steps, 10]).tick_values(low, high)]
    theirs = [value for value in theirs if low < value < high]
    assert even_numbers(low, high, most, steps) == pytest.approx(theirs, abs=1e-6 * span)


def test_a_number_that_rounding_takes_beyond_a_bound_lies_on_it():
    assert even_numbers(1.02, 1.0278125, 3) == pytest.approx([1.02, 1.025])  # 1.02 / 0.005 is more than 204


def test_a_range_without_width_has_one_number():
    assert even_numbers(3.0, 3.0, 5) == [3.0]
