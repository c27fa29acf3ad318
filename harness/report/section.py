"""What a section of a page is, and how sections are found: each file of `harness/report/sections/` declares one.

The folder below `sections/` names the page: that of an experiment, or the overview.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from harness.modules import modules_in


@dataclass(frozen=True)
class Section:
    """What a file of `sections/` declares, as `SECTION`.

    Parameters
    ----------
    identity : the id of its element, by which it is linked
    title : in the list of contents; "" to leave it out of that
    place : among the sections of the page
    html : the section, whose element has that id; empty where there is nothing to say
    """

    identity: str
    title: str
    place: float
    html: Callable[[Any], Markup]


@dataclass(frozen=True)
class Written:
    """A section that has something to say, and what it says."""

    section: Section
    html: Markup


def sections_of(page: str, subject: object) -> list[Written]:
    """The sections of a page, in their order, those without anything to say left out.

    Parameters
    ----------
    page : the folder of `sections/`
    subject : what the page shows
    """
    sections = [module.SECTION for module in modules_in(f"harness.report.sections.{page}")]
    written = [Written(section, section.html(subject)) for section in sorted(sections, key=lambda found: found.place)]
    return [found for found in written if found.html]
