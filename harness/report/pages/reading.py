"""How to read the pages, and what is assumed."""

from __future__ import annotations

from harness.report.page import Content, Page
from harness.report.results import Results


def _content(results: Results) -> Content | None:
    return Content("how-to-read.html.j2", {}, results.records) if results.pages else None


PAGE = Page("reading.html", "How to read", 48, _content)
