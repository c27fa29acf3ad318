"""Stability: which methods survive which cases, which degrade, by how much, and which refuse?"""

from __future__ import annotations

from harness.report.page import Content, Page
from harness.report.results import Results
from harness.report.stability.case import MEANINGS, SIGNS, is_case


def _content(results: Results) -> Content | None:
    if results.stability is None:
        return None
    cases = [page for page in results.pages if is_case(page)]
    return Content(
        "stability.html.j2",
        {"matrix": results.stability, "signs": SIGNS, "meanings": MEANINGS, "cases": cases},
        [page.record for page in cases],
    )


PAGE = Page("stability.html", "Stability", 30, _content)
