"""A canvas of pixels that becomes an SVG element: small, without a script, its lettering in the page's own font.

A report draws hundreds of figures of a few lines each, so that their elements are written here as they are; matplotlib,
which takes a second to import and a tenth of one to draw such a figure, makes files of other formats of them.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Literal

from markupsafe import escape

from harness.report.drawing import palette
from harness.report.drawing.markers import outline, px

# What is drawn while somebody collects it, for files of another format than SVG.
_collected: ContextVar[list[Canvas] | None] = ContextVar("_collected", default=None)
FileFormat = Literal["pdf", "png"]
_ANCHORS = {"left": "", "center": ' text-anchor="middle"', "right": ' text-anchor="end"'}


@contextmanager
def collected() -> Iterator[list[Canvas]]:
    """The canvases that become SVG in the meantime, in order."""
    found: list[Canvas] = []
    token = _collected.set(found)
    try:
        yield found
    finally:
        _collected.reset(token)


@dataclass(frozen=True)
class Stroke:
    """A line with or without markers."""

    xs: Sequence[float]
    ys: Sequence[float]
    colour: str
    width: float
    dashes: tuple[float, float] | None
    marker: str | None
    size: float
    hollow: bool
    alpha: float | None

    @property
    def edge(self) -> float:
        """px, how wide the outlines of its markers are."""
        return 1.4 if self.hollow or self.marker == "|" else 0.6


@dataclass(frozen=True)
class Area:
    """A filled outline."""

    xs: Sequence[float]
    ys: Sequence[float]
    colour: str
    alpha: float


@dataclass(frozen=True)
class Lettering:
    """A text at its anchor."""

    x: float
    y: float
    text: str
    colour: str
    horizontal: Literal["left", "center", "right"]
    vertical: Literal["baseline", "center"]
    turned: bool


class Canvas:
    """A drawing of so many px that takes lines, polygons and texts at px from its lower left corner.

    Areas lie behind lines, and lines behind texts.
    """

    def __init__(self, width: float, height: float, font: float) -> None:
        self.width = width
        self.height = height
        self.font = font
        self.areas: list[Area] = []
        self.strokes: list[Stroke] = []
        self.texts: list[Lettering] = []
        self._hovers: list[tuple[float, float, float, float, str]] = []

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
        """A line with or without markers; nan interrupts it. Dashes and the gaps between them are in widths of it."""
        self.strokes.append(Stroke(xs, ys, colour, width, dashes, marker, size, hollow, alpha))

    def area(self, xs: Sequence[float], ys: Sequence[float], colour: str, alpha: float = 0.2) -> None:
        """A filled outline, pale."""
        self.areas.append(Area(xs, ys, colour, alpha))

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
        # a third of the font size is near enough to half the height of a letter
        if vertical == "center" and not turned:
            y, vertical = y - self.font * 0.35, "baseline"
        if text:
            self.texts.append(Lettering(x, y, text, colour, horizontal, vertical, turned))

    def svg(self, name: str) -> str:
        """The SVG element alone: no prologue, ids of its own, lettering in the page's font."""
        found = _collected.get()
        if found is not None:
            found.append(self)
        symbols: dict[str, str] = {}
        prefix = f"g{zlib.crc32(name.encode()):x}-"
        parts = [self._area(area) for area in self.areas]
        for stroke in self.strokes:
            if stroke.width:
                parts.append(self._stroke(stroke))
            if stroke.marker is not None:
                parts.append(self._markers(stroke, prefix, symbols))
        parts += [self._text(text) for text in self.texts]
        box = f'viewBox="0 0 {self.width:g} {self.height:g}" font-size="{self.font:g}"'
        defined = f"<defs>{''.join(symbols.values())}</defs>" if symbols else ""
        return f"<svg {box}>{defined}{''.join(parts)}{self._hover_elements()}</svg>"

    def file(self, form: FileFormat) -> bytes:
        """The drawing as a file in light colours on white: PDF with its lettering as text, or PNG at twice the px."""
        from harness.report.drawing.plot_file import plot_file  # of matplotlib, which most reports do without

        return plot_file(self, form)

    def _path(self, xs: Sequence[float], ys: Sequence[float]) -> str:
        parts = []
        step = "M"
        for x, y in zip(xs, ys, strict=True):
            if math.isfinite(x) and math.isfinite(y):
                parts.append(f"{step}{px(x)} {px(self.height - y)}")
                step = "L"
            else:
                step = "M"
        return "".join(parts)

    def _area(self, area: Area) -> str:
        faded = f' opacity="{area.alpha:g}"' if area.alpha < 1.0 else ""
        return f'<path d="{self._path(area.xs, area.ys)}z" fill="{area.colour}"{faded}/>'

    def _stroke(self, stroke: Stroke) -> str:
        faded = "" if stroke.alpha is None else f' opacity="{stroke.alpha:g}"'
        ends = ' stroke-linecap="square"'
        if stroke.dashes is not None:
            ends = f' stroke-dasharray="{",".join(px(part * stroke.width) for part in stroke.dashes)}"'
        wide = "" if stroke.width == 1.0 else f' stroke-width="{px(stroke.width)}"'
        path = self._path(stroke.xs, stroke.ys)
        return f'<path d="{path}" fill="none" stroke="{stroke.colour}"{wide}{ends}{faded}/>' if path else ""

    def _markers(self, stroke: Stroke, prefix: str, symbols: dict[str, str]) -> str:
        """Markers of one line share their style; the outline of each kind and size is in `symbols` once."""
        shape = outline(stroke.marker or "", stroke.size / 2.0)
        if shape not in symbols:
            symbols[shape] = f'<path id="{prefix}{len(symbols)}" d="{shape}"/>'
        identity = f"{prefix}{list(symbols).index(shape)}"
        style = f'fill="{palette.PAGE if stroke.hollow else stroke.colour}" stroke="{stroke.colour}"'
        uses = "".join(
            f'<use href="#{identity}" x="{px(x)}" y="{px(self.height - y)}"/>'
            for x, y in zip(stroke.xs, stroke.ys, strict=True)
            if math.isfinite(x) and math.isfinite(y)
        )
        return f'<g {style} stroke-width="{px(stroke.edge)}">{uses}</g>' if uses else ""

    def _text(self, text: Lettering) -> str:
        x, y = text.x, self.height - text.y
        if not text.turned:
            place = f'x="{px(x)}" y="{px(y)}"'
            anchor = _ANCHORS[text.horizontal]
        else:
            # upwards, its middle or its beginning at the anchor; the baseline is a quarter of a size beside its middle
            place = f'transform="translate({px(x + 0.26 * self.font)} {px(y)})rotate(-90)"'
            anchor = _ANCHORS["center" if text.vertical == "center" else "left"]
        return f'<text {place}{anchor} fill="{text.colour}">{escape(text.text)}</text>'

    def _hover_elements(self) -> str:
        elements = [
            f'<rect x="{x:.4g}" y="{y:.4g}" width="{width:.4g}" height="{height:.4g}">'
            f"<title>{escape(text)}</title></rect>"
            for x, y, width, height, text in self._hovers
        ]
        return f'<g fill="none" pointer-events="all">{"".join(elements)}</g>' if elements else ""
