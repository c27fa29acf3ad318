"""Figures, below each other."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.section import Section


def _html(page: ExperimentPage) -> Markup:
    figures = page.figures.get("figures")
    return render("experiment/figures.html.j2", figures=figures) if figures else Markup()


SECTION = Section("figures", "Figures", 20, _html)
