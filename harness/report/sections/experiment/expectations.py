"""What became of the expectations."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.section import Section
from harness.report.verdicts import verdicts_html


def _html(page: ExperimentPage) -> Markup:
    return verdicts_html("expectations", "Expectations", page.record.expectations)


SECTION = Section("expectations", "Expectations", 70, _html)
