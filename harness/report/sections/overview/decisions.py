"""What to use, at which accuracy."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.pages.accuracy import FILE
from harness.report.section import Section


def _html(overview: Overview) -> Markup:
    found = [
        (f"{FILE}#{accuracy.identity}", said) for accuracy in overview.results.accuracy for said in accuracy.decisions
    ]
    return render("overview/decisions.html.j2", decisions=found) if found else Markup()


SECTION = Section("decisions", "", 10, _html)
