"""What became of the claims."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.section import Section
from harness.report.verdicts import verdicts_html


def _html(page: ExperimentPage) -> Markup:
    return verdicts_html("claims", "Claims", page.record.claims)


SECTION = Section("claims", "Claims", 60, _html)
