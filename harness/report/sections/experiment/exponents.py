"""Growth exponents: of what is compared, with a figure, then of everything else."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.section import Section
from harness.report.tables.exponents import exponents_table


def _html(page: ExperimentPage) -> Markup:
    if not page.growths:
        return Markup()
    first = [entry for entry in page.growths if page.compares(entry)]
    rest = [entry for entry in page.growths if not page.compares(entry)]
    tables = [exponents_table(entries, page.arrangement) for entries in (first, rest) if entries]
    return render("experiment/exponents.html.j2", tables=tables, figures=page.figures.get("exponents"))


SECTION = Section("exponents", "Exponents", 30, _html)
