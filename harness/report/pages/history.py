"""How the run time went over all sweeps of each machine, and where it changed for good."""

from __future__ import annotations

from harness.report.history.history import FEWEST_SWEEPS, history
from harness.report.history.page import points_table, sentences, steps_table, sweeps_table
from harness.report.machine import machine_text
from harness.report.page import Content, Page
from harness.report.results import Results
from harness.report.sweeps.difference import CLOCK


def _content(results: Results) -> Content | None:
    machines = [machine for machine in history(results.database) if len(machine.sweeps) > 1]
    if not machines:
        return None
    values = {
        "sentences": sentences(machines),
        "fewest": FEWEST_SWEEPS,
        "machines": [
            (
                machine.fingerprint,
                machine_text(machine.facts),
                [sweeps_table(machine), steps_table(machine), points_table(machine, CLOCK)],
            )
            for machine in machines
        ],
    }
    return Content("history.html.j2", values, results.records)


PAGE = Page("history.html", "History", 45, _content)
