"""Series against series, and every point with what it measured."""

from __future__ import annotations

from urllib.parse import urlencode

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.pages.points import FILE
from harness.report.section import Section
from harness.report.tables.points import clocks_table, others_table, tests_table
from harness.report.tables.ranked import ranked_tables


def _html(page: ExperimentPage) -> Markup:
    found = page.arrangement
    tables = [table for table in (tests_table(found), clocks_table(found)) if table is not None]
    return render(
        "experiment/results.html.j2",
        ranked=ranked_tables(found),
        tables=tables,
        details=others_table(found),
        explore=f"{page.up}{FILE}#{urlencode({'experiment': page.record.name})}",
    )


SECTION = Section("results", "Results", 40, _html)
