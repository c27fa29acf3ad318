"""How far each method is from what memory allows."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.section import Section
from harness.report.tables.points import memory_table


def _html(page: ExperimentPage) -> Markup:
    table = memory_table(page.arrangement)
    return render("experiment/roofline.html.j2", table=table) if table else Markup()


SECTION = Section("roofline", "How far from memory", 32, _html)
