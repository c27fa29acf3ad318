"""Two bodies cut by a plane."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.report.drawing import palette
from harness.report.drawing.axes import FONT, WIDTHS
from harness.report.drawing.canvas import Canvas


def draw_cut(cuts: Sequence[Sequence[Sequence[float]]], name: str) -> str:
    """Two bodies cut by a plane, each as segments, as an SVG element of 340 px in sentinel colours."""
    width, height = WIDTHS["card"], 220.0
    canvas = Canvas(width, height, FONT)
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
            canvas.line(xs, ys, palette.colour(style), 1.8, dashes=dashes)
    length = 10.0 ** math.floor(math.log10(120 / zoom))
    start = width - 16 - length * zoom
    canvas.line([start, start + length * zoom], [14, 14], palette.SOFT, 2.0)
    canvas.text(start - 8, 14, f"{length:g} m", palette.SOFT, "right", "center")
    return canvas.svg(name)
