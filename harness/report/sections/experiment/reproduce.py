"""Commands, specification, assumptions, environment and data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import YamlLexer

from harness.measure.conditions import CONDITIONS
from harness.report.experiment import ExperimentPage
from harness.report.machine import machine_rows
from harness.report.markup import render
from harness.report.quantity import number
from harness.report.section import Section
from harness.store.records import SweepRecord

_CONDITIONS = ("load", "steal", "frequency", "flights")


def _html(page: ExperimentPage) -> Markup:
    downloads = [
        ("runs.csv", "runs, CSV"),
        ("specification.yaml", "specification"),
        ("environment.json", "environment, JSON"),
    ]
    downloads += [(figure.file, f"{figure.title}, SVG") for figures in page.figures.values() for figure in figures]
    return render(
        "experiment/reproduce.html.j2",
        command=page.record.sweep.command,
        specification=Markup(highlight(page.record.source, YamlLexer(), HtmlFormatter(nowrap=True))),
        environment=[*_sweep_rows(page.record.sweep), *_condition_rows(page.conditions)],
        downloads=downloads,
    )


def _sweep_rows(sweep: SweepRecord) -> list[tuple[str, str]]:
    packages = ", ".join(f"{name} {version}" for name, version in sweep.packages.items())
    return [
        ("swept", f"{sweep.started} – {sweep.finished or 'not finished'}"),
        ("command", sweep.command),
        ("harness", f"{sweep.version}, commit {sweep.commit or 'unknown'}"),
        *machine_rows(sweep.machine),
        ("packages", packages),
    ]


def _condition_rows(conditions: Sequence[Mapping[str, float]]) -> list[tuple[str, str]]:
    """What the runs met on their machines: load, stolen time, clock rate."""
    rows = []
    for name in _CONDITIONS:
        meaning, unit = CONDITIONS[name]
        values = sorted(run[name] for run in conditions if name in run)
        if values:
            low, middle, high = (_condition(values[at], unit) for at in (0, len(values) // 2, -1))
            said = low if low == high else f"{low} to {high}, median {middle}"
            rows.append((name, f"{said} ({meaning})"))
    return rows


def _condition(value: float, unit: str) -> str:
    if unit == "Hz":
        return f"{number(value / 1e9)} GHz"
    return f"{number(value)} %" if unit == "%" else number(value)


SECTION = Section("reproduce", "Reproduce", 120, _html)
