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
    known = {name: arrangement.controls[name] for name in arrangement.metrics if name in arrangement.controls}
    if not known:
        return ""
    listed = ", ".join(f"±{number(100 * found.floor)} % in {metric_title(name)}" for name, found in known.items())
    pairs = max(len(found.distances) for found in known.values())
    return (
        f"Noise floor: {listed}. So far apart were runs of the same point done twice (median of "
        f"{plural(pairs, 'pair')}); no smaller difference is called one."
    )


SECTION = Section("findings", "Findings", 10, _html)
