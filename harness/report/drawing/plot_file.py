"""A drawing as a file of another format than SVG, by matplotlib: in light colours on white."""

from __future__ import annotations

import io
import logging
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.text import Text
from matplotlib.transforms import IdentityTransform

from harness.report.drawing import palette

if TYPE_CHECKING:
    from harness.report.drawing.canvas import Canvas, FileFormat

# it tells at length, and in its own words, that a home which cannot be written to holds no cache of its fonts
logging.getLogger("matplotlib").setLevel(logging.ERROR)
_RC: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "text.parse_math": False,
    "pdf.fonttype": 42,
}
# Times and versions of programs would make the bytes of a file differ.
_UNDATED: dict[FileFormat, dict[str, None]] = {
    "pdf": dict.fromkeys(("CreationDate", "Creator", "Producer")),
    "png": {"Software": None},
}


def plot_file(canvas: Canvas, form: FileFormat) -> bytes:
    """The bytes of a file: PDF with its lettering as text, or PNG at twice the px of the drawing."""
    buffer = io.BytesIO()
    with mpl.rc_context(_RC):
        _figure(canvas).savefig(buffer, format=form, dpi=144, facecolor="#ffffff", metadata=_UNDATED[form])
    return buffer.getvalue()


def _figure(canvas: Canvas) -> Figure:
    figure = Figure(figsize=(canvas.width / 72, canvas.height / 72), dpi=72)
    for area in canvas.areas:
        corners = list(zip(area.xs, area.ys, strict=True))
        fill = palette.light(area.colour)
        figure.add_artist(Polygon(corners, color=fill, alpha=area.alpha, linewidth=0, transform=IdentityTransform()))
    for line in canvas.strokes:
        colour = palette.light(line.colour)
        figure.add_artist(
            Line2D(
                line.xs, line.ys, color=colour, linewidth=line.width, alpha=line.alpha,
                linestyle=(0, line.dashes) if line.dashes else "-",
                marker=line.marker, markersize=line.size, markeredgewidth=line.edge,
                markerfacecolor=palette.light(palette.PAGE) if line.hollow else colour, transform=IdentityTransform(),
            )
        )  # fmt: skip
    for text in canvas.texts:
        figure.add_artist(
            Text(text.x, text.y, text.text, color=palette.light(text.colour), fontsize=canvas.font,
                 rotation=90.0 if text.turned else 0.0, horizontalalignment=text.horizontal,
                 verticalalignment=text.vertical, transform=IdentityTransform())
        )  # fmt: skip
    return figure
