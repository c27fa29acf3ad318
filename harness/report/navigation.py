"""The way through the report: the overview, its parts, and every other page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from harness.report.experiment import ExperimentPage
from harness.report.page import Page
from harness.report.section import Section

OVERVIEW = "index.html"


@dataclass(frozen=True)
class Link:
    """One entry of the navigation; `here` marks the page that it stands on."""

    title: str
    href: str
    here: bool = False


@dataclass(frozen=True)
class Navigation:
    """The entries as the overview has them."""

    links: tuple[Link, ...]

    def on(self, file: str) -> list[Link]:
        """As they stand on a page at the top."""
        return [replace(link, here=link.href == file) for link in self.links]

    def on_experiment(self, page: ExperimentPage) -> list[Link]:
        """As they stand on the page of an experiment, which comes last."""
        return [
            *(replace(link, href=f"{page.up}{link.href}") for link in self.links),
            Link(page.record.name, "", here=True),
        ]


def navigation(parts: Sequence[Section], pages: Sequence[Page]) -> Navigation:
    """To the overview, those of its sections that have a title, and the other pages."""
    overview = Link("Overview", OVERVIEW)
    below = (Link(part.title, f"{OVERVIEW}#{part.identity}") for part in parts if part.title)
    return Navigation((overview, *below, *(Link(page.title, page.file) for page in pages)))
