"""Runs that failed, with their reasons."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import section_html
from harness.report.section import Section
from harness.report.tables.failures import failures_table


def _html(page: ExperimentPage) -> Markup:
    table = failures_table(page.arrangement)
    return Markup() if table is None else section_html("failures", table.name, table)


SECTION = Section("failures", "Failures", 50, _html)
