"""Where on the axis of gaps backends disagree: a row of marks for every two of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from harness.report.drawing import palette
from harness.report.drawing.axes import CHARACTER, FONT, WIDTHS, Form, shorten
from harness.report.drawing.canvas import Canvas
from harness.report.quantity import power_of_ten

DECADES = 16
"""To either side of contact: from 1e-16 to a tenth of the size and more."""

Row = Mapping[str, Mapping[int, int]]


def draw_gaps(rows: Mapping[str, Row], kinds: Sequence[str], form: Form, name: str) -> str:
    """A row of marks for each pair of backends, as an SVG element in sentinel colours.

    Parameters
    ----------
    rows : by name, of every kind of disagreement how many lie in which signed decade
    kinds : whose place is their colour and shape
    form : "wide" 1080 px, "narrow" 360 px with names above the rows
    name : prefix of every id in the drawing
    """
    wide = form == "wide"
    width, height = WIDTHS[form], 34.0 if wide else 52.0
    left = min(330.0, 24 + CHARACTER * max(map(len, rows))) if wide else 10.0
    canvas = Canvas(width, height * len(rows) + 62, FONT)
    bottom, top = 44.0, 44.0 + height * len(rows)
    step = (width - left - 16) / (2 * DECADES + 1)

    def x(decade: float) -> float:
        return left + (decade + DECADES + 0.5) * step

    for decade in range(-DECADES, DECADES + 1):
        canvas.line([x(decade)] * 2, [bottom, top], palette.GRID, 1.0)
    canvas.line([x(0)] * 2, [bottom - 4, top + 4], palette.SOFT, 1.0, dashes=(2, 2))
    for decade, text in _ticks(wide):
        canvas.text(x(decade), bottom - 18, text, horizontal="center")
    canvas.text(x(-DECADES / 2), bottom - 38, "overlap" if not wide else "overlap, of size", palette.SOFT, "center")
    canvas.text(x(DECADES / 2), bottom - 38, "gap" if not wide else "gap, of size", palette.SOFT, "center")
    for place, (label, row) in enumerate(rows.items()):
        y = top - height * (place + 0.5)
        if wide:
            canvas.text(left - 12, y, label, horizontal="right", vertical="center")
        else:
            canvas.text(left, y + 13, shorten(label, 48))
            y -= 8
        canvas.line([x(-DECADES), x(DECADES)], [y, y], palette.GRID, 1.0)
        for kind in sorted(row, key=lambda kind: -sum(row[kind].values())):
            style = kinds.index(kind)
            for decade, count in row[kind].items():
                size = (4.0 if wide else 3.5) + (3.0 if wide else 1.6) * math.log10(count)
                canvas.line([x(decade)], [y], palette.colour(style), 0.0, marker=palette.marker(style), size=size)
    return canvas.svg(name)


def _ticks(wide: bool) -> list[tuple[int, str]]:
    marks = (15, 12, 9, 6, 3) if wide else (9, 3)
    places = [(DECADES + 1 - mark, mark) for mark in marks]
    left = [(-place, f"−{power_of_ten(-mark)}") for place, mark in places]
    return [*left, (0, "0"), *((place, power_of_ten(-mark)) for place, mark in places)]
