"""What was found, a sentence an experiment."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.section import Section


def _html(overview: Overview) -> Markup:
    return render("overview/findings.html.j2", overview=overview) if overview.cards else Markup()


SECTION = Section("findings", "", 20, _html)
