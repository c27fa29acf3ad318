"""A canvas of pixels that becomes an SVG element: small, without a script, its lettering in the page's own font.

Figures are put together from matplotlib's lines, polygons and texts, without its axes: those cost three times as much
as all the rest, and a report draws hundreds.
"""

from __future__ import annotations

import io
import re
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Literal

import matplotlib as mpl
from markupsafe import escape
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.text import Text
from matplotlib.transforms import IdentityTransform

from harness.report.drawing import palette

_RC: dict[Any, Any] = {
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "text.parse_math": False,
}
_NOTHING = dict.fromkeys(("Date", "Creator", "Format", "Type"))


# What is drawn while somebody collects it, for files of another format than SVG.
_collected: ContextVar[list[Canvas] | None] = ContextVar("_collected", default=None)
FileFormat = Literal["pdf", "png"]
# Times and versions of programs would make the bytes of a file differ.
_UNDATED: dict[FileFormat, dict[str, None]] = {
    "pdf": dict.fromkeys(("CreationDate", "Creator", "Producer")),
    "png": {"Software": None},
}


@contextmanager
def collected() -> Iterator[list[Canvas]]:
    """The canvases that become SVG in the meantime, in order."""
    found: list[Canvas] = []
    token = _collected.set(found)
    try:
        yield found
    finally:
        _collected.reset(token)


class Canvas:
    """A matplotlib figure of so many px that takes lines, polygons and texts at px."""

    def __init__(self, width: float, height: float, font: float) -> None:
        self.width = width
        self.height = height
        self.font = font
        self._hovers: list[tuple[float, float, float, float, str]] = []
        self._figure = Figure(figsize=(width / 72, height / 72), dpi=72)
        self._figure.patch.set_visible(False)

    def line(
        self,
        xs: Sequence[float],
        ys: Sequence[float],
        colour: str,
        width: float,
        *,
        dashes: tuple[float, float] | None = None,
        marker: str | None = None,
        size: float = 0.0,
        hollow: bool = False,
        alpha: float | None = None,
    ) -> None:
        """A line with or without markers; nan interrupts it."""
        self._figure.add_artist(
            Line2D(
                xs, ys, color=colour, linewidth=width, linestyle=(0, dashes) if dashes else "-", alpha=alpha,
                marker=marker, markersize=size, markeredgewidth=1.4 if hollow or marker == "|" else 0.6,
                markerfacecolor=palette.PAGE if hollow else colour, transform=IdentityTransform(),
            )
        )  # fmt: skip

    def area(self, xs: Sequence[float], ys: Sequence[float], colour: str, alpha: float = 0.2) -> None:
        """A filled outline, pale."""
        corners = list(zip(xs, ys, strict=True))
        self._figure.add_artist(Polygon(corners, color=colour, alpha=alpha, linewidth=0, transform=IdentityTransform()))

    def hover(self, x: float, y: float, width: float, height: float, text: str) -> None:
        """A text that shows while a pointer is over a rectangle with this lower left corner."""
        self._hovers.append((x, self.height - y - height, width, height, text))

    def text(
        self,
        x: float,
        y: float,
        text: str,
        colour: str = palette.INK,
        horizontal: Literal["left", "center", "right"] = "left",
        vertical: Literal["baseline", "center"] = "baseline",
        turned: bool = False,
    ) -> None:
        """A text at its anchor."""
        angle = 90.0 if turned else 0.0
        # matplotlib centres a line of text by measuring it; a third of the font size is near enough, and quick
        if vertical == "center" and not turned:
            y, vertical = y - self.font * 0.35, "baseline"
        if text:
            self._figure.add_artist(
                Text(x, y, text, color=colour, fontsize=self.font, rotation=angle, horizontalalignment=horizontal,
                     verticalalignment=vertical, transform=IdentityTransform())
            )  # fmt: skip

    def svg(self, name: str) -> str:
        """The SVG element alone: no prologue, no metadata, ids of its own, lettering in the page's font."""
        found = _collected.get()
        if found is not None:
            found.append(self)
        buffer = io.StringIO()
        with mpl.rc_context(_RC | {"svg.hashsalt": name}):
            self._figure.savefig(buffer, format="svg", metadata=_NOTHING)
        text = buffer.getvalue()
        text = text[text.index("<svg") :]
        text = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", text, flags=re.DOTALL)
        box = f'viewBox="0 0 {self.width:g} {self.height:g}" font-size="{self.font:g}"'
        text = re.sub(r"<svg[^>]*>", f"<svg {box}>", text, count=1)
        text = re.sub(r'<g id="[^"]*">', "<g>", text)
        text = re.sub(r"font: [^;\"]*;? ?|font-family: [^;\"]*;? ?| transform=\"rotate\(-0 [^\"]*\"", "", text)
        text = re.sub(r"<[^>]+>", _shortened, text)
        text = re.sub(r">\s+<", "><", re.sub(r"\s*\n\s*", " ", text))
        text = re.sub(r"<g>((?:<use [^>]*/>)+)</g>", _styled_once, text)
        return _named(text, name).strip().replace("</svg>", f"{self._hover_elements()}</svg>")

    def file(self, form: FileFormat) -> bytes:
        """The drawing as a file in light colours on white: PDF with its lettering as text, or PNG at twice the px."""
        for artist in self._figure.get_children():
            if isinstance(artist, Line2D):
                artist.set_color(palette.light(artist.get_color()))
                artist.set_markerfacecolor(palette.light(artist.get_markerfacecolor()))
                artist.set_markeredgecolor(palette.light(artist.get_markeredgecolor()))
            elif isinstance(artist, Text):
                artist.set_color(palette.light(artist.get_color()))
            elif isinstance(artist, Polygon):
                artist.set_facecolor(palette.light(artist.get_facecolor()))
        self._figure.patch.set_visible(True)
        buffer = io.BytesIO()
        with mpl.rc_context({**_RC, "pdf.fonttype": 42}):
            self._figure.savefig(buffer, format=form, dpi=144, facecolor="#ffffff", metadata=_UNDATED[form])
        return buffer.getvalue()

    def _hover_elements(self) -> str:
        elements = [
            f'<rect x="{x:.4g}" y="{y:.4g}" width="{width:.4g}" height="{height:.4g}">'
            f"<title>{escape(text)}</title></rect>"
            for x, y, width, height, text in self._hovers
        ]
        return f'<g fill="none" pointer-events="all">{"".join(elements)}</g>' if elements else ""


def _shortened(tag: re.Match[str]) -> str:
    """Hundredths of px are enough in a tag; what is written between tags stays as it is."""
    return re.sub(r"(\.\d\d)\d+", r"\1", tag.group(0))


def _styled_once(group: re.Match[str]) -> str:
    """Markers of one line share their style: said once, it makes a drawing a third smaller."""
    styles = set(re.findall(r' style="[^"]*"', group.group(1)))
    if len(styles) != 1:
        return group.group(0)
    (style,) = styles
    return f"<g{style}>{group.group(1).replace(style, '')}</g>"


def _named(text: str, name: str) -> str:
    """Short ids of the drawing's own, and plain references to them."""
    prefix = f"g{zlib.crc32(name.encode()):x}"
    for place, identity in enumerate(dict.fromkeys(re.findall(r'\bid="([^"]+)"', text))):
        text = text.replace(f'id="{identity}"', f'id="{prefix}-{place}"')
        text = text.replace(f'xlink:href="#{identity}"', f'href="#{prefix}-{place}"')
    return text
