"""What a page beside those of experiments is, and how pages are found: each file of `harness/report/pages/` is one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from harness.modules import modules_in
from harness.report.figure import Figure
from harness.report.results import Results
from harness.store.records import ExperimentRecord


@dataclass(frozen=True)
class Content:
    """What stands on a page.

    Parameters
    ----------
    template : that shows it
    values : that the template asks for
    records : the experiments that it comes from
    figures : that can be had as files
    files : further files that it links, by their paths
    """

    template: str
    values: Mapping[str, Any]
    records: Sequence[ExperimentRecord]
    figures: Sequence[Figure] = ()
    files: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Page:
    """What a file of `pages/` declares, as `PAGE`.

    Parameters
    ----------
    file : below the report
    title : in the navigation
    place : there
    content : made from all results; None where they have nothing for it, and there is no such page
    """

    file: str
    title: str
    place: float
    content: Callable[[Results], Content | None]


def pages_of(results: Results) -> list[tuple[Page, Content]]:
    """The pages that there are, in the order of the navigation."""
    pages = [module.PAGE for module in modules_in("harness.report.pages")]
    made = [(page, page.content(results)) for page in sorted(pages, key=lambda page: page.place)]
    return [(page, content) for page, content in made if content is not None]
