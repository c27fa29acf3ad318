"""Errors against run time: which method is fastest at the accuracy that I need?"""

from __future__ import annotations

from harness.report.page import Content, Page
from harness.report.results import Results

FILE = "accuracy.html"


def _content(results: Results) -> Content | None:
    found = results.accuracy
    if not found:
        return None
    return Content(
        "accuracy.html.j2",
        {"experiments": found, "decisions": [said for accuracy in found for said in accuracy.decisions]},
        results.records,
        [figure for accuracy in found for figure in accuracy.figures],
    )


PAGE = Page(FILE, "Error against run time", 10, _content)
