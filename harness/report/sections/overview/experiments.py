"""Every experiment, folder by folder, and the cases of stability."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.section import Section


def _html(overview: Overview) -> Markup:
    return render("overview/experiments.html.j2", overview=overview)


SECTION = Section("experiments", "", 40, _html)
