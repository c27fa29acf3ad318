"""How to do what people come for: choose a method, measure errors, compare, and so on."""

from __future__ import annotations

from harness.report.page import Content, Page
from harness.report.results import Results


def _content(results: Results) -> Content | None:
    return Content("how-to.html.j2", {}, results.records) if results.pages else None


PAGE = Page("how-to.html", "How to", 47, _content)
