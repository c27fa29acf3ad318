"""Claims, and what became of them."""

from __future__ import annotations

from harness.report.overview import Overview
from harness.report.page import Content, Page
from harness.report.results import Results


def _content(results: Results) -> Content | None:
    """Those of the homework first, whose numbers these are held against."""
    claims = Overview(results).claims
    homework = [(page, row) for page, row in claims if str(row.criterion.get("source", "")).startswith("homework")]
    others = [claim for claim in claims if claim not in homework]
    found = [(title, rows) for title, rows in (("Of the homework", homework), ("Of our own", others)) if rows]
    return Content("claims.html.j2", {"claims": found}, results.records) if found else None


PAGE = Page("claims.html", "Claims", 6, _content)
