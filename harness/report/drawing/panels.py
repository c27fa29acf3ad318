"""Lines with bands or bars over one pair of axes or several."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from textwrap import wrap

from harness.report.drawing import palette
from harness.report.drawing.axes import (
    CHARACTER,
    FONT,
    WIDTHS,
    Form,
    PanelFrame,
    round_numbers,
    shorten,
    tick_text,
    x_ticks,
    y_ticks,
)
from harness.report.drawing.canvas import Canvas
from harness.report.quantity import number

_CARD_FONT = 11.0
_POINTER = 9.0  # px around a point in which its text shows
_ROW = 17.0  # px between direct labels
_LEFT = 84.0  # px for tick labels and the turned y label


@dataclass(frozen=True)
class Line:
    """One series in a panel; `low` and `high` bound its band, where it has one.

    A dashed line with hollow markers is somebody else's: published, not measured here. `spans` are the intervals of x,
    where it was measured too; `texts` show while a pointer is over a point; `doubtful` are the places of the points
    that do not count, drawn hollow.
    """

    label: str
    style: int
    x: tuple[float, ...]
    y: tuple[float, ...]
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    foreign: bool = False
    spans: tuple[tuple[float, float], ...] = ()
    doubtful: tuple[int, ...] = ()
    texts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Panel:
    """One pair of axes. With `categories`, x counts them from 0.

    With `logarithmic` both axes are, with `logarithmic_x` at least that of x.

    `front` are the corners (x, y) of a staircase behind the lines: what no point beats in both x and y. With `rounded`,
    the ticks of x are round numbers, not the measured ones.
    """

    title: str
    x_label: str
    y_label: str
    lines: tuple[Line, ...]
    categories: tuple[str, ...] = ()
    logarithmic: bool = False
    logarithmic_x: bool = False
    x_text: Callable[[float], str] = number
    front: tuple[tuple[float, float], ...] = ()
    rounded: bool = False


def draw_panels(panels: Sequence[Panel], form: Form, name: str, labels: bool = True) -> str:
    """Panels side by side (wide) or one below the other (narrow) as an SVG element in sentinel colours.

    Parameters
    ----------
    panels : at least one
    form : "wide" 1080 px, "narrow" 360 px, "card" 340 px with neither labels nor titles
    name : prefix of every id in the drawing, unique on its page
    labels : whether series are named at the ends of their lines, where there is room for it
    """
    columns = 1 if form != "wide" or len(panels) == 1 else 2
    rows = math.ceil(len(panels) / columns)
    width = WIDTHS[form] / columns
    height = {"wide": 440.0 if columns == 1 else 330.0, "narrow": 290.0, "card": 170.0}[form]
    canvas = Canvas(width * columns, height * rows, FONT if form != "card" else _CARD_FONT)
    for place, panel in enumerate(panels):
        corner = (place % columns * width, (rows - 1 - place // columns) * height)
        _panel(canvas, panel, _frame(panel, corner, (width, height), form, labels), form, labels)
    return canvas.svg(name)


def _frame(
    panel: Panel, corner: tuple[float, float], size: tuple[float, float], form: Form, labels: bool
) -> PanelFrame:
    left, bottom, top, right = (44.0, 26.0, 12.0, 10.0) if form == "card" else (_LEFT, 52.0, 34.0, 14.0)
    if labels and form == "wide":
        right = min(size[0] * 0.34, 22 + CHARACTER * max((len(line.label) for line in panel.lines), default=0))
    right = max(right, _half_of_last_tick(panel, form))
    return PanelFrame(
        corner[0] + left,
        corner[1] + bottom,
        corner[0] + size[0] - right,
        corner[1] + size[1] - top,
        _x_range(panel),
        _y_range(panel),
        panel.logarithmic or panel.logarithmic_x,
        panel.logarithmic,
    )


def _half_of_last_tick(panel: Panel, form: Form) -> float:
    """px to the right of the frame that the text below its last measured value needs, which is centred there."""
    if panel.categories or panel.rounded:
        return 0.0
    last = max((value for line in panel.lines for value in line.x), default=None)
    digit = 0.6 * (FONT if form != "card" else _CARD_FONT)  # px, of which numbers consist
    return 0.0 if last is None else digit * len(panel.x_text(last)) / 2


def _panel(canvas: Canvas, panel: Panel, frame: PanelFrame, form: Form, labels: bool) -> None:
    x_ticks(canvas, frame, _x_texts(panel, frame, form))
    y_ticks(canvas, frame, 4 if form == "card" else 7)
    canvas.line([frame.left, frame.left, frame.right], [frame.top, frame.bottom, frame.bottom], palette.SOFT, 1.0)
    if panel.front:
        _front(canvas, panel, frame)
    for line in panel.lines:
        _line(canvas, panel, line, frame, form)
    if form == "card":
        return
    _x_label(canvas, panel, frame, form)
    if panel.title:
        letters = (frame.right - frame.left) / CHARACTER
        canvas.text(frame.left, frame.top + 13, shorten(panel.title, letters))
        middle = (frame.bottom + frame.top) / 2
        canvas.text(frame.left - _LEFT + 9, middle, panel.y_label, horizontal="center", vertical="center", turned=True)
    else:
        # flat above the axis where there is no title: it is read without turning one's head
        canvas.text(frame.left, frame.top + 13, panel.y_label, palette.SOFT)
    if labels and form == "wide":
        _label_ends(canvas, panel, frame)


def _x_label(canvas: Canvas, panel: Panel, frame: PanelFrame, form: Form) -> None:
    """What x is, in one line where it fits, else in two."""
    middle = (frame.left + frame.right) / 2
    # of the panel on both sides of the middle of its axis: all of its left margin, and a usual one on the right
    room = frame.right - frame.left + 2 * (_LEFT if form == "wide" else canvas.width - frame.right)
    lines = wrap(panel.x_label, int(room / CHARACTER)) if len(panel.x_label) * CHARACTER > room else [panel.x_label]
    for place, text in enumerate(lines):
        canvas.text(middle, frame.bottom - (42 if len(lines) == 1 else 33) - 15 * place, text, horizontal="center")


def _line(canvas: Canvas, panel: Panel, line: Line, frame: PanelFrame, form: Form) -> None:
    colour = palette.SOFT if line.foreign else palette.colour(line.style)
    xs, ys = [frame.x(value) for value in line.x], [frame.y(value) for value in line.y]
    low, high = [frame.y(value) for value in line.low], [frame.y(value) for value in line.high]
    if low and panel.categories:
        for x, bottom, top in zip(xs, low, high, strict=True):
            canvas.line([x, x], [bottom, top], colour, 3.0, alpha=0.5)
    elif len(low) > 1:
        canvas.area([*xs, *reversed(xs)], [*low, *reversed(high)], colour)
    # categories have nothing between them, so nothing is drawn there but a guide for the eye
    dashes = (4.0, 3.0) if line.foreign else (1.0, 3.0) if panel.categories else None
    marker = palette.MARKERS[0] if line.foreign else palette.marker(line.style)
    width, size = (1.5, 3.5) if form == "card" else (2.0, 6.0)
    canvas.line(xs, ys, colour, width, dashes=dashes, marker=marker, size=size, hollow=line.foreign)
    for (left, right), y in zip(line.spans, ys if line.spans else (), strict=True):
        canvas.line([frame.x(left), frame.x(right)], [y, y], colour, 4.0, alpha=0.45)
    if form != "card":
        for x, y, text in zip(xs, ys, line.texts, strict=False):
            canvas.hover(x - _POINTER, y - _POINTER, 2 * _POINTER, 2 * _POINTER, text)
    for place in line.doubtful:
        canvas.line([xs[place]], [ys[place]], colour, 0.0, marker=marker, size=size, hollow=True)


def _front(canvas: Canvas, panel: Panel, frame: PanelFrame) -> None:
    """A broad pale staircase: from a corner on, its error is to be had at every higher cost."""
    xs, ys = [], []
    for place, (x, y) in enumerate(panel.front):
        later = panel.front[place + 1][0] if place + 1 < len(panel.front) else frame.x_range[1]
        xs += [frame.x(x), frame.x(later)]
        ys += [frame.y(y), frame.y(y)]
    canvas.line([xs[0], *xs], [frame.top, *ys], palette.SOFT, 7.0, alpha=0.25)


def _x_range(panel: Panel) -> tuple[float, float]:
    if panel.categories:
        return -0.5, len(panel.categories) - 0.5
    xs = [value for line in panel.lines for value in (*line.x, *chain(*line.spans))] or [0.0, 1.0]
    low, high = min(xs), max(xs)
    if panel.logarithmic or panel.logarithmic_x:
        factor = (high / low) ** 0.04 if high > low else 2.0
        return low / factor, high * factor
    margin = 0.04 * (high - low) or abs(high) / 2 or 1.0
    return low - margin, high + margin


def _y_range(panel: Panel) -> tuple[float, float]:
    values = [value for line in panel.lines for value in (*line.y, *line.low, *line.high) if math.isfinite(value)]
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    if panel.logarithmic:
        factor = (high / low) ** 0.06 if high > low else 2.0
        return low / factor, high * factor
    spread = high - min(low, 0.0) or abs(high) or 1.0
    return (low - 0.06 * spread if low < 0 else 0.0), high + 0.08 * spread


def _x_texts(panel: Panel, frame: PanelFrame, form: Form) -> list[tuple[float, str]]:
    """Ticks at the measured values themselves, as many as fit."""
    character = CHARACTER * (0.85 if form == "card" else 1.0)
    if panel.categories:
        letters = (frame.right - frame.left) / len(panel.categories) / character
        step = max(1, math.ceil(7 / letters))
        named = enumerate(panel.categories)
        return [(float(place), shorten(text, letters * step - 1)) for place, text in named if place % step == 0]
    if panel.rounded:
        letters = int((frame.right - frame.left) / (9 * character))
        return [(value, tick_text(value)) for value in round_numbers(frame.x_range, frame.logarithmic_x, letters)]
    kept: list[tuple[float, str]] = []
    edge = -math.inf
    for value in sorted({value for line in panel.lines for value in line.x}):
        text = panel.x_text(value)
        half = character * len(text) / 2 + 4
        if frame.x(value) - half >= edge:
            kept.append((value, text))
            edge = frame.x(value) + half
    return kept


def _label_ends(canvas: Canvas, panel: Panel, frame: PanelFrame) -> None:
    """Name every line at its right end; labels that would overlap are moved apart and led to their line."""
    ends = [(line, frame.x(line.x[-1]), frame.y(line.y[-1])) for line in panel.lines if line.y]
    ends.sort(key=lambda end: (end[2], end[0].label))
    heights = _apart([y for _, _, y in ends], _ROW, frame.bottom, frame.top)
    edge = canvas.width if frame.right > canvas.width / 2 else canvas.width / 2
    for (line, x, y), height in zip(ends, heights, strict=True):
        if abs(height - y) > 2 or frame.right - x > 24:
            canvas.line([x + 6, frame.right + 10], [y, height], palette.colour(line.style), 0.8, alpha=0.7)
        text = shorten(line.label, (edge - frame.right - 14) / CHARACTER)
        canvas.text(frame.right + 14, height, text, vertical="center")


def _apart(places: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """The nearest places (in order) that keep the gap and the bounds: least squares by pooling neighbours."""
    blocks: list[tuple[float, int]] = []
    for index, place in enumerate(places):
        total, size = place - index * gap, 1
        while blocks and blocks[-1][0] / blocks[-1][1] > total / size:
            earlier, length = blocks.pop()
            total, size = total + earlier, size + length
        blocks.append((total, size))
    level = [total / size for total, size in blocks for _ in range(size)]
    top = max(low, high - (len(places) - 1) * gap)
    return [min(max(value, low), top) + index * gap for index, value in enumerate(level)]
