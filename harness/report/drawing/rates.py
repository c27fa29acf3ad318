"""Rates of two kinds in a matrix: a mark for each, the larger the higher, and the number beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from harness.report.drawing import palette
from harness.report.drawing.axes import CHARACTER, FONT, WIDTHS, Form
from harness.report.drawing.canvas import Canvas


def draw_rates(
    columns: Sequence[str],
    rows: Sequence[str],
    rates: Mapping[tuple[str, str], tuple[float, int]],
    form: Form,
    name: str,
) -> str:
    """A matrix of marks, as an SVG element in sentinel colours.

    Parameters
    ----------
    columns, rows : headings
    rates : by column and row, how many in a million, and the style; what is not there was not asked
    form : "wide" 1080 px; "narrow" 360 px, with the columns' names turned and no numbers
    name : prefix of every id in the drawing
    """
    wide = form == "wide"
    width, height = WIDTHS[form], 34.0 if wide else 30.0
    left = 24 + CHARACTER * max(map(len, rows))
    head = 40.0 if wide else 20 + CHARACTER * max(map(len, columns))
    canvas = Canvas(width, height * len(rows) + head + 8, FONT)
    top = 8 + height * len(rows)
    step = (width - left - 8) / len(columns)
    for column, title in enumerate(columns):
        x = left + (column + 0.5) * step
        if wide:
            canvas.text(x, top + 14, title, horizontal="center")
        else:
            canvas.text(x + 4, top + 8, title, turned=True, horizontal="center")
    for row, family in enumerate(rows):
        y = top - height * (row + 0.5)
        canvas.text(left - 14, y, family, horizontal="right", vertical="center")
        canvas.line([left, width - 8], [y - height / 2] * 2, palette.GRID, 1.0)
        for column, engine in enumerate(columns):
            if (engine, family) not in rates:
                continue
            rate, style = rates[engine, family]
            x = left + (column + (0.3 if wide else 0.5)) * step
            if rate <= 0.0:
                canvas.line([x - 5, x + 5], [y, y], palette.SOFT, 1.2)
                continue
            size = 4.0 + 2.2 * max(0.0, math.log10(rate))
            canvas.line([x], [y], palette.colour(style), 0.0, marker=palette.marker(style), size=size)
            if wide:
                canvas.text(x + 14, y, _rate(rate), vertical="center")
    return canvas.svg(name)


def _rate(rate: float) -> str:
    """Two digits, with a thin space between thousands."""
    digits = max(0, 1 - math.floor(math.log10(rate)))
    return f"{round(rate, 1 - math.floor(math.log10(rate))):,.{digits}f}".replace(",", "\u202f")
