"""What is broken or failed, in any experiment."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.section import Section


def _html(overview: Overview) -> Markup:
    failures = overview.failures
    return render("overview/broken.html.j2", failures=failures) if failures else Markup()


SECTION = Section("broken", "", 30, _html)
