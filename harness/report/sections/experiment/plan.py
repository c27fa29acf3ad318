"""The plan: which stages every point keeps, which are left out, and why."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.plan import stages
from harness.report.section import Section


def _html(page: ExperimentPage) -> Markup:
    found = stages(page.arrangement)
    return render("experiment/plan.html.j2", stages=found) if found else Markup()


SECTION = Section("plan", "Plan", 100, _html)
