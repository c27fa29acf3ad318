"""How to read the page."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.section import Section


def _html(page: ExperimentPage) -> Markup:
    return render("experiment/reading.html.j2")


SECTION = Section("reading", "How to read", 110, _html)
