"""Drawings of the page of backends: where on the axis of gaps they disagree, and two bodies cut by a plane."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from harness.report import palette
from harness.report.canvas import Canvas
from harness.report.drawing import Form

DECADES = 16
"""To either side of contact: from 1e-16 to a tenth of the size and more."""

_FONT = 13.0
_CHARACTER = 7.0

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
    width, height = (1080.0, 34.0) if wide else (360.0, 52.0)
    left = min(330.0, 24 + _CHARACTER * max(map(len, rows))) if wide else 10.0
    canvas = Canvas(width, height * len(rows) + 62, _FONT)
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
            canvas.text(left, y + 13, label[:48])
            y -= 8
        canvas.line([x(-DECADES), x(DECADES)], [y, y], palette.GRID, 1.0)
        for kind in sorted(row, key=lambda kind: -sum(row[kind].values())):
            style = kinds.index(kind)
            for decade, count in row[kind].items():
                size = (4.0 if wide else 3.5) + (3.0 if wide else 1.6) * math.log10(count)
                canvas.line([x(decade)], [y], palette.colour(style), 0.0, marker=palette.marker(style), size=size)
    return canvas.svg(name)


def draw_section(cuts: Sequence[Sequence[Sequence[float]]], name: str) -> str:
    """Two bodies cut by a plane, each as segments, as an SVG element of 340 px in sentinel colours."""
    width, height = 340.0, 220.0
    canvas = Canvas(width, height, _FONT)
    points = [(x, y) for cut in cuts for segment in cut for x, y in (segment[:2], segment[2:])]
    if not points:
        return canvas.svg(name)
    low = [min(point[axis] for point in points) for axis in (0, 1)]
    high = [max(point[axis] for point in points) for axis in (0, 1)]
    zoom = min((width - 24) / ((high[0] - low[0]) or 1.0), (height - 50) / ((high[1] - low[1]) or 1.0))
    middle = [(low[axis] + high[axis]) / 2 for axis in (0, 1)]

    def place(x: float, y: float) -> tuple[float, float]:
        return width / 2 + (x - middle[0]) * zoom, height / 2 + 12 + (y - middle[1]) * zoom

    # one dashed, so that both are seen where they coincide
    for cut, style, dashes in zip(cuts, (0, 2), (None, (5.0, 4.0)), strict=True):
        xs: list[float] = []
        ys: list[float] = []
        for x1, y1, x2, y2 in cut:
            (ax, ay), (bx, by) = place(x1, y1), place(x2, y2)
            xs += [ax, bx, math.nan]
            ys += [ay, by, math.nan]
        if xs:
            canvas.line(xs, ys, palette.colour(style), 1.8, dashes)
    length = 10.0 ** math.floor(math.log10(120 / zoom))
    start = width - 16 - length * zoom
    canvas.line([start, start + length * zoom], [14, 14], palette.SOFT, 2.0)
    canvas.text(start - 8, 14, f"{length:g} m", palette.SOFT, "right", "center")
    return canvas.svg(name)


def _ticks(wide: bool) -> list[tuple[int, str]]:
    marks = (15, 12, 9, 6, 3) if wide else (9, 3)
    places = [(17 - mark, mark) for mark in marks]
    left = [(-place, f"−1e−{mark}") for place, mark in places]
    return [*left, (0, "0"), *((place, f"1e−{mark}") for place, mark in places)]
