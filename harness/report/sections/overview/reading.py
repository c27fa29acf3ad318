"""How to read the pages."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.section import Section


def _html(overview: Overview) -> Markup:
    return render("overview/reading.html.j2")


SECTION = Section("reading", "", 70, _html)
