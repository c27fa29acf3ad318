"""A picture of the scene, which leads to its replay."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.section import Section


def _html(page: ExperimentPage) -> Markup:
    return Markup() if page.replay is None else render("experiment/replay.html.j2", replay=page.replay)


SECTION = Section("replay", "Replay", 90, _html)
