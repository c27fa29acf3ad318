"""A map: cells side by side, each in the colour of a method and with its letter, hatched where it is in doubt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from harness.report.drawing import palette
from harness.report.drawing.axes import CHARACTER, FONT, WIDTHS, Form, shorten
from harness.report.drawing.canvas import Canvas

_LEFT, _BOTTOM, _TOP = 76.0, 46.0, 28.0
_ROW = 42.0  # px
_HATCH = 9.0  # px from line to line
_GAP = 1.5  # px of the page between cells


@dataclass(frozen=True)
class DrawnCell:
    """A cell: its column and row, the style and the letter of the method, whether in doubt, and what it says."""

    column: int
    row: int
    style: int
    letter: str
    doubtful: bool
    text: str


@dataclass(frozen=True)
class Grid:
    """A map with the texts of its columns, from the left, and of its rows, from the bottom."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[str, ...]
    x_label: str
    y_label: str
    cells: tuple[DrawnCell, ...]


def draw_maps(grids: Sequence[Grid], form: Form, name: str) -> str:
    """Maps side by side (wide) or one below the other as an SVG element in sentinel colours.

    Parameters
    ----------
    grids : at least one
    form : "wide" 1080 px, "narrow" 360 px, "card" 340 px
    name : prefix of every id in the drawing, unique on its page
    """
    across = min(3, len(grids)) if form == "wide" else 1
    width = WIDTHS[form] / across
    height = _TOP + _BOTTOM + _ROW * max(len(grid.rows) for grid in grids)
    lines = -(-len(grids) // across)
    canvas = Canvas(width * across, height * lines, FONT)
    for place, grid in enumerate(grids):
        _draw(canvas, grid, place % across * width, (lines - 1 - place // across) * height, width - 14.0)
    return canvas.svg(name)


def _draw(canvas: Canvas, grid: Grid, left: float, bottom: float, width: float) -> None:
    """One map with its lower left corner at (left, bottom)."""
    x, y = left + _LEFT, bottom + _BOTTOM
    column = (width - _LEFT) / len(grid.columns)
    for cell in grid.cells:
        _cell(canvas, cell, x + cell.column * column + _GAP, y + cell.row * _ROW + _GAP, column - 2 * _GAP)
    for place, text in enumerate(grid.columns):
        canvas.text(x + (place + 0.5) * column, y - 15, text, palette.SOFT, horizontal="center")
    for place, text in enumerate(grid.rows):
        canvas.text(x - 7, y + (place + 0.5) * _ROW, text, palette.SOFT, horizontal="right", vertical="center")
    canvas.text(x + (width - _LEFT) / 2, y - 36, grid.x_label, horizontal="center")
    middle = y + len(grid.rows) * _ROW / 2
    letters = len(grid.rows) * _ROW / CHARACTER
    canvas.text(left + 14, middle, shorten(grid.y_label, letters), horizontal="center", vertical="center", turned=True)
    canvas.text(x, y + len(grid.rows) * _ROW + 9, shorten(grid.title, (width - _LEFT) / CHARACTER))


def _cell(canvas: Canvas, cell: DrawnCell, x: float, y: float, width: float) -> None:
    height, colour = _ROW - 2 * _GAP, palette.colour(cell.style)
    canvas.area([x, x + width, x + width, x], [y, y, y + height, y + height], colour, alpha=0.34)
    canvas.line([x, x + width, x + width, x, x], [y, y, y + height, y + height, y], colour, 1.6)
    if cell.doubtful:
        start = -height
        while start < width:
            # a line upwards to the right, cut off at the sides of the cell
            low, high = max(0.0, -start), min(height, width - start)
            if high > low:
                canvas.line([x + start + low, x + start + high], [y + low, y + high], palette.SOFT, 0.9, alpha=0.8)
            start += _HATCH
        half = CHARACTER * len(cell.letter) / 2 + 5
        middle, centre = x + width / 2, y + height / 2
        canvas.area(
            [middle - half, middle + half, middle + half, middle - half],
            [centre - 9, centre - 9, centre + 9, centre + 9],
            palette.PAGE,
            alpha=1.0,
        )
    canvas.text(x + width / 2, y + height / 2, cell.letter, horizontal="center", vertical="center")
    canvas.hover(x, y, width, height, cell.text)
