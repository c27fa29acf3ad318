"""The data, and the machines that it comes from."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.machine import machine_rows, machine_text
from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.section import Section


def _html(overview: Overview) -> Markup:
    machines = [(machine_text(facts), machine_rows(facts)) for facts in overview.results.machines.values()]
    return render("overview/data.html.j2", machines=machines)


SECTION = Section("data", "Data", 60, _html)
