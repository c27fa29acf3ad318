"""What a figure is, and how figures are found: each file of `harness/report/figures/` declares one.

The folder below `figures/` names the page, and the file says in which section of it the figure stands. A figure says in
words what it shows, for those who cannot see it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from markupsafe import Markup, escape

from harness.modules import modules_in
from harness.report.drawing import palette
from harness.report.drawing.axes import Form
from harness.report.drawing.canvas import FileFormat, collected


@dataclass(frozen=True)
class Key:
    """One entry of a legend."""

    label: str
    style: int
    foreign: bool = False


@dataclass(frozen=True, eq=False)
class Figure:
    """One figure in all its forms; `name` is unique on its page and names its file."""

    name: str
    title: str
    description: str
    caption: str
    draw: Callable[[Form, str], str]
    keys: tuple[Key, ...] = ()
    labelled: bool = True
    file: str = ""

    def svg(self, form: Form) -> Markup:
        """The drawing for a page: its colours follow the page's."""
        return Markup(palette.themed(self._described(form)))

    @cached_property
    def document(self) -> str:
        """The wide drawing as a file of its own, in light colours on white."""
        text = palette.fixed(self._described("wide"))
        box = text.split('viewBox="', 1)[1].split('"', 1)[0]
        _, _, width, height = box.split()
        head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" '
        ground = f'<rect width="{width}" height="{height}" fill="#ffffff"/>'
        text = text.replace("<svg ", head, 1)
        return text.replace("</desc>", f"</desc>{ground}", 1) + "\n"

    def as_file(self, form: FileFormat) -> tuple[str, bytes]:
        """The wide drawing in another format: its path beside that of the SVG, and its bytes."""
        with collected() as canvases:
            self.draw("wide", f"{self.name}-wide")
        return f"{self.file.removesuffix('.svg')}.{form}", canvases[-1].file(form)

    def _described(self, form: Form) -> str:
        if form not in self._drawn:
            self._drawn[form] = self.draw(form, f"{self.name}-{form}")
        name = f"{self.name}-{form}"
        accessible = (
            f'<svg role="img" aria-labelledby="{name}-t" aria-describedby="{name}-d" \\g'
            f'<title id="{name}-t">{escape(self.title)}</title><desc id="{name}-d">{escape(self.description)}</desc>'
        )
        head, tail = self._drawn[form].split(">", 1)
        return accessible.replace("\\g", f"{head.removeprefix('<svg ')}>", 1) + tail

    @cached_property
    def _drawn(self) -> dict[Form, str]:
        return {}


@dataclass(frozen=True)
class FigureSource:
    """What a file of `figures/` declares, as `SOURCE`.

    Parameters
    ----------
    made : the figures of what the page shows; none where there is nothing to draw
    section : of the page, where they stand
    place : among the figures of the section
    """

    made: Callable[[Any], Iterable[Figure]]
    section: str = "figures"
    place: float = 50.0


def figure_name(*parts: str) -> str:
    """These as the name of a figure, without what neither an id nor the name of a file may have; empty ones left out.

    >>> figure_name("atlas", "", "hull of cow.obj")
    'atlas-hull-of-cow-obj'
    """
    return re.sub(r"[^\w-]+", "-", "-".join(filter(None, parts)))


def figures_of(page: str, subject: object) -> dict[str, list[Figure]]:
    """The figures of a page by section, each with the file that it is kept in.

    Parameters
    ----------
    page : the folder of `figures/`
    subject : what the page shows
    """
    sources = [module.SOURCE for module in modules_in(f"harness.report.figures.{page}")]
    found: dict[str, list[Figure]] = {}
    for source in sorted(sources, key=lambda source: source.place):
        figures = found.setdefault(source.section, [])
        figures += [
            figure if figure.file else replace(figure, file=f"{figure.name}.svg") for figure in source.made(subject)
        ]
    return found
