"""How the newest sweep differs from the newest before it that measured the same points."""

from __future__ import annotations

from harness.report.page import Content, Page
from harness.report.results import Results
from harness.report.sweeps.page import facts, points_table, summary


def _content(results: Results) -> Content | None:
    found = results.difference
    if found is None:
        return None
    values = {
        "sentences": summary(found),
        "verdicts": found.verdicts,
        "points": points_table(found),
        "before": facts(found.before),
        "after": facts(found.after),
    }
    return Content("sweeps.html.j2", values, results.records)


PAGE = Page("sweeps.html", "Sweeps compared", 40, _content)
