"""Published numbers beside ours, and what they contradict: computed from nothing but themselves."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.published import recovered
from harness.report.section import Section
from harness.report.sentences.contradictions import contradictions
from harness.report.tables.published import published_table, recovered_table


def _html(page: ExperimentPage) -> Markup:
    rows = page.published
    if not rows:
        return Markup()
    elsewhere = [row for other in page.all_pages if other is not page for row in other.published]
    block, found = page.record.specification["published"], recovered(rows)
    return render(
        "experiment/published.html.j2",
        table=published_table(rows, str(block.get("source", ""))),
        note=str(block.get("note") or ""),
        figures=page.figures.get("published", ()),
        sentences=contradictions(rows, elsewhere),
        counts=recovered_table(found) if found else None,
    )


SECTION = Section("published", "Published", 80, _html)
