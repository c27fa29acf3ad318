"""What to beware of."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.section import Section


def _html(page: ExperimentPage) -> Markup:
    if not page.findings.warnings:
        return Markup()
    return render("experiment/warnings.html.j2", sentences=page.findings.warnings)


SECTION = Section("warnings", "", 14, _html)
