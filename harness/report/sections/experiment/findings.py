"""What was found, in sentences, and how noisy it is."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.markup import render
from harness.report.quantity import number, plural
from harness.report.section import Section
from harness.report.series import Arrangement
from harness.report.words import metric_title


def _html(page: ExperimentPage) -> Markup:
    return render("experiment/findings.html.j2", findings=page.findings, noise=_noise_floor(page.arrangement))


def _noise_floor(arrangement: Arrangement) -> str:
    """What the control says, in a sentence; nothing where there is none."""
    floors = {name: floor for name in arrangement.metrics if (floor := arrangement.floor(name))}
    if not floors:
        return ""
    said = ", ".join(f"±{number(100 * floor)} % in {metric_title(name)}" for name, floor in floors.items())
    return (
        f"Noise floor: {said}. So far apart were runs of the same point done twice (median of "
        f"{plural(arrangement.controls, 'pair')}); no smaller difference is called one."
    )


SECTION = Section("findings", "Findings", 10, _html)
