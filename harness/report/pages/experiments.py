"""Every experiment with a card: its question, its first figure and what was found."""

from __future__ import annotations

from harness.report.overview import Overview
from harness.report.page import Content, Page
from harness.report.results import Results


def _content(results: Results) -> Content | None:
    overview = Overview(results)
    return Content("experiments.html.j2", {"overview": overview}, results.records) if overview.cards else None


PAGE = Page("experiments.html", "Experiments", 5, _content)
