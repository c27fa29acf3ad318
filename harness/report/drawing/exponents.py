"""Fitted exponents with their intervals, on one axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from harness.report.drawing import palette
from harness.report.drawing.axes import CHARACTER, FONT, Form, PanelFrame, even_numbers, shorten, tick_text, x_ticks
from harness.report.drawing.canvas import Canvas

_POWERS = {-1: "inverse", 0: "constant", 1: "linear", 2: "square", 3: "cube"}


@dataclass(frozen=True)
class Slope:
    """One fitted exponent with its interval, as a row of the figure."""

    label: str
    style: int
    value: float
    low: float
    high: float


def draw_exponents(exponents: Sequence[Slope], leaf: str, form: Form, name: str) -> str:
    """Fitted exponents with their intervals on one axis, with the whole numbers marked, as an SVG element."""
    width, height = 540.0 if form == "wide" else 360.0, 80.0 + 34.0 * len(exponents)
    left = min(width * (0.46 if form == "wide" else 0.58), 16 + CHARACTER * max(len(row.label) for row in exponents))
    lows = [row.low if math.isfinite(row.low) else row.value for row in exponents]
    highs = [row.high if math.isfinite(row.high) else row.value for row in exponents]
    x_range = (min(0.0, *lows) - 0.12, max(1.0, *highs) + 0.18)
    frame = PanelFrame(left, 50.0, width - 18, height - 30, x_range, (0.6 - len(exponents), 0.6), False, False)
    canvas = Canvas(width, height, FONT)
    ticks = even_numbers(*x_range, 5 if form == "narrow" else 7, (1, 2, 5))
    x_ticks(canvas, frame, [(tick, tick_text(tick)) for tick in ticks])
    for whole in range(math.ceil(x_range[0]), math.floor(x_range[1]) + 1):
        x = frame.x(whole)
        canvas.line([x, x], [frame.bottom, frame.top], palette.SOFT, 1.0, dashes=(2, 2))
        if frame.x(1) - frame.x(0) > 9 * CHARACTER:
            canvas.text(x, frame.top + 8, _POWERS.get(whole, ""), palette.SOFT, "center")
    for place, row in enumerate(exponents):
        y, colour = frame.y(-place), palette.colour(row.style)
        canvas.text(left - 10, y, shorten(row.label, (left - 12) / CHARACTER), horizontal="right", vertical="center")
        ends = [frame.x(lows[place]), frame.x(highs[place])]
        canvas.line(ends, [y, y], colour, 2.0, marker="|", size=9.0)
        canvas.line([frame.x(row.value)], [y], colour, 0.0, marker=palette.marker(row.style), size=7.0)
    canvas.text((frame.left + frame.right) / 2, frame.bottom - 42, f"exponent of {leaf}", horizontal="center")
    return canvas.svg(name)
