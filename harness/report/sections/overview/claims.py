"""Claims, and what became of them."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.section import Section


def _html(overview: Overview) -> Markup:
    """Those of the homework first, whose numbers these are held against."""
    claims = overview.claims
    homework = [claim for claim in claims if str(claim[1].criterion.get("source", "")).startswith("homework")]
    others = [claim for claim in claims if claim not in homework]
    found = [(title, rows) for title, rows in (("Of the homework", homework), ("Of our own", others)) if rows]
    return render("overview/claims.html.j2", claims=found) if found else Markup()


SECTION = Section("claims", "Claims", 50, _html)
