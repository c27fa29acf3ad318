"""Every point of every experiment in one table: to filter, arrange, group and take away."""

from __future__ import annotations

from harness.report.explore import explored
from harness.report.page import Content, Page
from harness.report.results import Results

FILE = "points.html"


def _content(results: Results) -> Content | None:
    columns, rows = explored(results.pages)
    return Content("points.html.j2", {"columns": columns, "rows": rows}, results.records) if rows else None


PAGE = Page(FILE, "All points", 5.5, _content)
