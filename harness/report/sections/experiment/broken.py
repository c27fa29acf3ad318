"""Expectations that do not hold, and runs that failed."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.section import Section
from harness.report.tables.failures import failures_table


def _html(page: ExperimentPage) -> Markup:
    if not page.findings.failures:
        return Markup()
    failed_runs = failures_table(page.arrangement) is not None
    return render("experiment/broken.html.j2", sentences=page.findings.failures, failed_runs=failed_runs)


SECTION = Section("broken", "", 12, _html)
