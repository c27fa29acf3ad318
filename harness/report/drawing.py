"""Drawing: lines with bands against a swept leaf, and exponents on one axis, as SVG without a script.

Every figure is drawn twice, wide for desks and narrow for phones, because the lettering of one scaled to the other
cannot be read.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Literal

from matplotlib.ticker import MaxNLocator

from harness.report import palette
from harness.report.canvas import Canvas
from harness.report.quantity import number, power_of_ten

Form = Literal["wide", "narrow", "card"]

_FONT, _CARD_FONT = 13.0, 11.0
_CHARACTER = 7.0  # px, generous for a proportional font at _FONT
_ROW = 17.0  # px between direct labels
_LEFT = 84.0  # px for tick labels and the turned y label
_POWERS = {-1: "inverse", 0: "constant", 1: "linear", 2: "square", 3: "cube"}


@dataclass(frozen=True)
class Line:
    """One series in a panel; `low` and `high` bound its band, where it has one.

    A dashed line with hollow markers is somebody else's: published, not measured here. `spans` are the intervals of x,
    where it was measured too; `doubtful` are the places of the points that do not count, drawn hollow.
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


@dataclass(frozen=True)
class Panel:
    """One pair of axes. With `categories`, x counts them from 0.

    `front` are the corners (x, y) of a staircase behind the lines: what no point beats in both x and y. With `rounded`,
    the ticks of x are round numbers, not the measured ones.
    """

    title: str
    x_label: str
    y_label: str
    lines: tuple[Line, ...]
    categories: tuple[str, ...] = ()
    logarithmic: bool = False
    x_text: Callable[[float], str] = number
    front: tuple[tuple[float, float], ...] = ()
    rounded: bool = False


@dataclass(frozen=True)
class Slope:
    """One fitted exponent with its interval, as a row of the figure."""

    label: str
    style: int
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class _Frame:
    """Where a panel lies, px from the bottom left, and what its edges mean."""

    left: float
    bottom: float
    right: float
    top: float
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    logarithmic: bool

    def x(self, value: float) -> float:
        """Place of a value of x, px."""
        return self.left + _share(value, self.x_range, self.logarithmic) * (self.right - self.left)

    def y(self, value: float) -> float:
        """Place of a value of y, px."""
        return self.bottom + _share(value, self.y_range, self.logarithmic) * (self.top - self.bottom)


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
    width = {"wide": 1080.0, "narrow": 360.0, "card": 340.0}[form] / columns
    height = {"wide": 440.0 if columns == 1 else 330.0, "narrow": 290.0, "card": 170.0}[form]
    canvas = Canvas(width * columns, height * rows, _FONT if form != "card" else _CARD_FONT)
    for place, panel in enumerate(panels):
        corner = (place % columns * width, (rows - 1 - place // columns) * height)
        _panel(canvas, panel, _frame(panel, corner, (width, height), form, labels), form, labels)
    return canvas.svg(name)


def draw_exponents(exponents: Sequence[Slope], leaf: str, form: Form, name: str) -> str:
    """Fitted exponents with their intervals on one axis, with the whole numbers marked, as an SVG element."""
    width, height = 540.0 if form == "wide" else 360.0, 80.0 + 34.0 * len(exponents)
    left = min(width * (0.46 if form == "wide" else 0.58), 16 + _CHARACTER * max(len(row.label) for row in exponents))
    lows = [row.low if math.isfinite(row.low) else row.value for row in exponents]
    highs = [row.high if math.isfinite(row.high) else row.value for row in exponents]
    x_range = (min(0.0, *lows) - 0.12, max(1.0, *highs) + 0.18)
    frame = _Frame(left, 50.0, width - 18, height - 30, x_range, (0.6 - len(exponents), 0.6), False)
    canvas = Canvas(width, height, _FONT)
    ticks = MaxNLocator(5 if form == "narrow" else 7, steps=[1, 2, 5, 10]).tick_values(*x_range)
    _x_ticks(canvas, frame, [(float(tick), _tick(float(tick))) for tick in ticks if x_range[0] <= tick <= x_range[1]])
    for whole in range(math.ceil(x_range[0]), math.floor(x_range[1]) + 1):
        x = frame.x(whole)
        canvas.line([x, x], [frame.bottom, frame.top], palette.SOFT, 1.0, dashes=(2, 2))
        if frame.x(1) - frame.x(0) > 9 * _CHARACTER:
            canvas.text(x, frame.top + 8, _POWERS.get(whole, ""), palette.SOFT, "center")
    for place, row in enumerate(exponents):
        y, colour = frame.y(-place), palette.colour(row.style)
        canvas.text(left - 10, y, _shorten(row.label, (left - 12) / _CHARACTER), horizontal="right", vertical="center")
        ends = [frame.x(lows[place]), frame.x(highs[place])]
        canvas.line(ends, [y, y], colour, 2.0, marker="|", size=9.0)
        canvas.line([frame.x(row.value)], [y], colour, 0.0, marker=palette.marker(row.style), size=7.0)
    canvas.text((frame.left + frame.right) / 2, frame.bottom - 42, f"exponent of {leaf}", horizontal="center")
    return canvas.svg(name)


def _frame(panel: Panel, corner: tuple[float, float], size: tuple[float, float], form: Form, labels: bool) -> _Frame:
    left, bottom, top, right = (44.0, 26.0, 12.0, 10.0) if form == "card" else (_LEFT, 52.0, 34.0, 14.0)
    if labels and form == "wide":
        right = min(size[0] * 0.34, 22 + _CHARACTER * max((len(line.label) for line in panel.lines), default=0))
    return _Frame(
        corner[0] + left,
        corner[1] + bottom,
        corner[0] + size[0] - right,
        corner[1] + size[1] - top,
        _x_range(panel),
        _y_range(panel),
        panel.logarithmic,
    )


def _panel(canvas: Canvas, panel: Panel, frame: _Frame, form: Form, labels: bool) -> None:
    _x_ticks(canvas, frame, _x_texts(panel, frame, form))
    _y_ticks(canvas, frame, 4 if form == "card" else 7)
    canvas.line([frame.left, frame.left, frame.right], [frame.top, frame.bottom, frame.bottom], palette.SOFT, 1.0)
    if panel.front:
        _front(canvas, panel, frame)
    for line in panel.lines:
        _line(canvas, panel, line, frame, form)
    if form == "card":
        return
    canvas.text((frame.left + frame.right) / 2, frame.bottom - 42, panel.x_label, horizontal="center")
    if panel.title:
        room = (frame.right - frame.left) / _CHARACTER
        canvas.text(frame.left, frame.top + 13, _shorten(panel.title, room))
        middle = (frame.bottom + frame.top) / 2
        canvas.text(frame.left - _LEFT + 9, middle, panel.y_label, horizontal="center", vertical="center", turned=True)
    else:
        # flat above the axis where there is no title: it is read without turning one's head
        canvas.text(frame.left, frame.top + 13, panel.y_label, palette.SOFT)
    if labels and form == "wide":
        _label_ends(canvas, panel, frame)


def _line(canvas: Canvas, panel: Panel, line: Line, frame: _Frame, form: Form) -> None:
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
    canvas.line(xs, ys, colour, width, dashes, marker, size, line.foreign)
    for (left, right), y in zip(line.spans, ys if line.spans else (), strict=True):
        canvas.line([frame.x(left), frame.x(right)], [y, y], colour, 4.0, alpha=0.45)
    for place in line.doubtful:
        canvas.line([xs[place]], [ys[place]], colour, 0.0, None, marker, size, True)


def _front(canvas: Canvas, panel: Panel, frame: _Frame) -> None:
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
    if panel.logarithmic:
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


def _x_texts(panel: Panel, frame: _Frame, form: Form) -> list[tuple[float, str]]:
    """Ticks at the measured values themselves, as many as have room."""
    character = _CHARACTER * (0.85 if form == "card" else 1.0)
    if panel.categories:
        room = (frame.right - frame.left) / len(panel.categories) / character
        step = max(1, math.ceil(7 / room))
        named = enumerate(panel.categories)
        return [(float(place), _shorten(text, room * step - 1)) for place, text in named if place % step == 0]
    if panel.rounded:
        room = int((frame.right - frame.left) / (9 * character))
        return [(value, _tick(value)) for value in _round_numbers(frame.x_range, panel.logarithmic, room)]
    kept: list[tuple[float, str]] = []
    edge = -math.inf
    for value in sorted({value for line in panel.lines for value in line.x}):
        text = panel.x_text(value)
        half = character * len(text) / 2 + 4
        if frame.x(value) - half >= edge:
            kept.append((value, text))
            edge = frame.x(value) + half
    return kept


def _x_ticks(canvas: Canvas, frame: _Frame, ticks: Sequence[tuple[float, str]]) -> None:
    places = [frame.x(value) for value, _ in ticks]
    canvas.line(
        [value for x in places for value in (x, x, math.nan)],
        [value for _ in places for value in (frame.bottom, frame.top, math.nan)],
        palette.GRID,
        1.0,
    )
    for x, (_, text) in zip(places, ticks, strict=True):
        canvas.text(x, frame.bottom - canvas.font - 5, text, horizontal="center")


def _y_ticks(canvas: Canvas, frame: _Frame, most: int) -> None:
    ticks = _round_numbers(frame.y_range, frame.logarithmic, most)
    places = [frame.y(value) for value in ticks]
    canvas.line(
        [value for _ in places for value in (frame.left, frame.right, math.nan)],
        [value for y in places for value in (y, y, math.nan)],
        palette.GRID,
        1.0,
    )
    for y, value in zip(places, ticks, strict=True):
        canvas.text(frame.left - 7, y, _tick(value), horizontal="right", vertical="center")


def _round_numbers(bounds: tuple[float, float], logarithmic: bool, most: int) -> list[float]:
    """Round numbers within bounds: 1, 2, 5 of every power of ten, or fewer of each where that is too many."""
    low, high = bounds
    if not logarithmic:
        found = MaxNLocator(most - 1, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        return [float(value) for value in found if low <= value <= high]
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    inside: list[float] = []
    for steps in ((1, 2, 5), (1, 3), (1,)):
        values = [float(f"{step}e{power}") for power in powers for step in steps]
        inside = [value for value in values if low <= value <= high]
        if len(inside) <= most:
            return inside
    return inside[:: math.ceil(len(inside) / most)]


def _label_ends(canvas: Canvas, panel: Panel, frame: _Frame) -> None:
    """Name every line at its right end; labels that would overlap are moved apart and led to their line."""
    ends = [(line, frame.x(line.x[-1]), frame.y(line.y[-1])) for line in panel.lines if line.y]
    ends.sort(key=lambda end: (end[2], end[0].label))
    heights = _apart([y for _, _, y in ends], _ROW, frame.bottom, frame.top)
    edge = canvas.width if frame.right > canvas.width / 2 else canvas.width / 2
    for (line, x, y), height in zip(ends, heights, strict=True):
        if abs(height - y) > 2 or frame.right - x > 24:
            canvas.line([x + 6, frame.right + 10], [y, height], palette.colour(line.style), 0.8, alpha=0.7)
        text = _shorten(line.label, (edge - frame.right - 14) / _CHARACTER)
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


def _share(value: float, bounds: tuple[float, float], logarithmic: bool) -> float:
    """Where a value lies between two bounds, 0 to 1."""
    low, high = bounds
    if logarithmic:
        return math.log(value / low) / math.log(high / low)
    return (value - low) / (high - low)


def _tick(value: float) -> str:
    """A round number of an axis, without the zeros that three significant digits would add; far from 1, its power."""
    if value > 0.0 and not 1e-3 <= value < 1e6 and math.isclose(power := math.log10(value), round(power)):
        return power_of_ten(round(power))
    return number(value) if value.is_integer() else f"{value:.4g}".replace("-", "−")


def _shorten(text: str, characters: float) -> str:
    keep = max(2, int(characters))
    return text if len(text) <= keep else f"{text[: keep - 1]}…"
