"""What stands on each page: an experiment's, from its record and runs, and the overview, from all of them."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import PurePosixPath
from typing import Any

import pandas as pd
from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import YamlLexer

from harness.measure.conditions import CONDITIONS
from harness.measure.metrics import METRICS
from harness.report.contradictions import contradictions
from harness.report.criteria import refusals
from harness.report.drawing import Slope
from harness.report.figures import Figure, exponent_figure, metric_figures, published_figure
from harness.report.findings import Findings, findings, stability
from harness.report.plan import Stage, stages
from harness.report.published import Row, published_rows, recovered
from harness.report.quantity import leaf_text, number, plural, quantity
from harness.report.ranking import Growth, growth
from harness.report.series import Arrangement, arrange
from harness.report.table import Table
from harness.report.tables import (
    clocks_table,
    comparisons,
    exponents_table,
    failures_table,
    others_table,
    published_table,
    recovered_table,
    tests_table,
)
from harness.report.words import metric_title, setting
from harness.store.records import ControlRecord, ExperimentRecord
from harness.vocabulary import MethodName

# Exponents are told for what the experiment asks for and for these counts, which have no noise.
_COUNTS = ("pair_tests", "box_tests", "narrow_tests", "predictions", "events")
_MOST_VALUES = 6
_CONDITIONS = ("load", "steal", "frequency", "flights")
_MOST_SLOPES = 24


@dataclass(frozen=True, eq=False)
class ExperimentPage:
    """All that an experiment's page says.

    Parameters
    ----------
    record : of the experiment
    runs : rows of the run table that belong to it
    folder : where the page lies below the report
    controls : of its points
    met : conditions of its runs
    wrong : methods that were proven wrong at its poses
    """

    record: ExperimentRecord
    runs: pd.DataFrame
    folder: PurePosixPath
    controls: Sequence[ControlRecord] = ()
    met: Sequence[Mapping[str, float]] = ()
    wrong: Collection[MethodName] = ()

    @cached_property
    def arrangement(self) -> Arrangement:
        """Its points as series."""
        return arrange(self.record, self.runs, self.controls, self.wrong)

    @cached_property
    def growths(self) -> list[Growth]:
        """Exponents of its metrics, and of the counts that change."""
        medians = {name: {point.median(name) for point in self.arrangement.points} for name in _COUNTS}
        counts = [name for name, values in medians.items() if sum(value > 0 for value in values) > 1]
        return growth(self.arrangement, tuple(dict.fromkeys((*self.arrangement.metrics, *counts))))

    @cached_property
    def findings(self) -> Findings:
        """What it found, in sentences."""
        return findings(self.record, self.arrangement, self.growths)

    @cached_property
    def figures(self) -> list[Figure]:
        """Its figures, each with the file it is kept in."""
        return [replace(figure, file=f"{figure.name}.svg") for figure in metric_figures(self.arrangement)]

    @cached_property
    def exponents(self) -> list[Table]:
        """Tables of exponents: of what is compared, then of everything else. None where x is no number."""
        if not self.growths:
            return []
        first = [entry for entry in self.growths if self._compared(entry)]
        rest = [entry for entry in self.growths if not self._compared(entry)]
        return [exponents_table(entries, self.arrangement) for entries in (first, rest) if entries]

    @cached_property
    def exponent_figure(self) -> Figure | None:
        """The exponents of what is compared; None where there is too little range for any."""
        several = len(self.arrangement.series) > 1
        rows = [
            Slope(
                ", ".join(filter(None, (entry.series.label, entry.series.panel))) if several else entry.metric,
                entry.series.style if several else place,
                entry.exponent.value,
                entry.exponent.low,
                entry.exponent.high,
            )
            for place, entry in enumerate(self.growths)
            if entry.exponent.enough and self._compared(entry)
        ]
        if not rows or len(rows) > _MOST_SLOPES or self.arrangement.x is None:
            return None
        metric = self.arrangement.metrics[0] if several else ""
        return replace(exponent_figure(rows, self.arrangement.x, metric), file="exponents.svg")

    def _compared(self, entry: Growth) -> bool:
        """Of several series the first metric is compared, of a lone one all its metrics."""
        return len(self.arrangement.series) == 1 or entry.metric == self.arrangement.metrics[0]

    @cached_property
    def comparisons(self) -> list[Table]:
        """Series against series, a table a metric and panel."""
        return comparisons(self.arrangement)

    @cached_property
    def tables(self) -> list[Table]:
        """Every point: tests and times, clocks."""
        return [table for table in (tests_table(self.arrangement), clocks_table(self.arrangement)) if table]

    @cached_property
    def details(self) -> Table | None:
        """Every point: hits, errors and memory."""
        return others_table(self.arrangement)

    @cached_property
    def failures(self) -> Table | None:
        """Runs that failed."""
        return failures_table(self.arrangement)

    @cached_property
    def published(self) -> list[Row]:
        """Published rows beside ours."""
        return published_rows(self.record.name, self.record.specification.get("published") or {}, self.arrangement)

    @cached_property
    def stages(self) -> list[Stage]:
        """The plan."""
        return stages(self.arrangement)

    @property
    def stability(self) -> str:
        """Stable, noisy, or nothing that can be said."""
        return stability(self.arrangement)

    @property
    def noise(self) -> str:
        """What the control says, in a sentence; nothing where there is none."""
        floors = {name: floor for name in self.arrangement.metrics if (floor := self.arrangement.floor(name))}
        if not floors:
            return ""
        said = ", ".join(f"±{number(100 * floor)} % in {metric_title(name)}" for name, floor in floors.items())
        return (
            f"Noise floor: {said}. So far apart were runs of the same point done twice (median of "
            f"{plural(self.arrangement.controls, 'pair')}); no smaller difference is called one."
        )

    @property
    def conditions(self) -> list[tuple[str, str]]:
        """What its runs met on their machines: load, stolen time, clock rate."""
        rows = []
        for name in _CONDITIONS:
            meaning, unit = CONDITIONS[name]
            values = sorted(run[name] for run in self.met if name in run)
            if values:
                low, middle, high = (_condition(values[at], unit) for at in (0, len(values) // 2, -1))
                said = low if low == high else f"{low} to {high}, median {middle}"
                rows.append((name, f"{said} ({meaning})"))
        return rows

    @property
    def failed(self) -> int:
        """How many runs failed; those that were refused as expected did not."""
        return int((self.runs["status"] != "ok").sum()) - refusals(self.record, self.runs)

    @property
    def summary(self) -> str:
        """What is swept, how often, where: one line."""
        parts = []
        for leaf in self.record.specification.get("swept") or ():
            values = list({leaf_text(point.parameters.get(leaf)): 0 for point in self.arrangement.points})
            said = ", ".join(values) if len(values) <= _MOST_VALUES else f"{values[0]} … {values[-1]}"
            parts.append(f"{leaf} {said}" + (f" ({len(values)} values)" if len(values) > _MOST_VALUES else ""))
        repeats = sorted({int(count) for count in self.runs.groupby("point").size()}) if len(self.runs) else [0]
        each = plural(repeats[0], "repeat") if len(repeats) == 1 else f"{repeats[0]} to {repeats[-1]} repeats"
        points = plural(len(self.record.points), "point")
        return "; ".join([*parts, f"{points}, {each} each, on {machine_text(self.record.sweep.machine)}"])

    @property
    def specification(self) -> Markup:
        """The experiment file, highlighted."""
        return Markup(highlight(self.record.source, YamlLexer(), HtmlFormatter(nowrap=True)))

    @property
    def csv(self) -> str:
        """Its runs as CSV."""
        return csv(self.runs)

    @property
    def environment(self) -> dict[str, Any]:
        """The sweep that listed it: command, versions, machine."""
        sweep = self.record.sweep
        return {
            "started": sweep.started,
            "finished": sweep.finished,
            "command": sweep.command,
            "commit": sweep.commit,
            "version": sweep.version,
            "machine": dict(sweep.machine),
            "fingerprint": sweep.fingerprint,
            "packages": dict(sweep.packages),
        }


@dataclass(frozen=True, eq=False)
class PublishedSection:
    """Published numbers beside ours, and what they contradict: computed from nothing but themselves."""

    table: Table
    figure: Figure | None
    note: str
    counts: Table | None
    sentences: tuple[Markup, ...]


def published_section(page: ExperimentPage, elsewhere: Sequence[Row]) -> PublishedSection | None:
    """The section of a page with `published:` rows; `elsewhere` are those of the other experiments."""
    rows = page.published
    if not rows:
        return None
    block = page.record.specification["published"]
    found = recovered(rows)
    figure = published_figure(rows, str(block.get("source", "")))
    return PublishedSection(
        published_table(rows, str(block.get("source", ""))),
        replace(figure, file="published.svg") if figure else None,
        str(block.get("note") or ""),
        recovered_table(found) if found else None,
        tuple(contradictions(rows, elsewhere)),
    )


def _condition(value: float, unit: str) -> str:
    if unit == "Hz":
        return f"{number(value / 1e9)} GHz"
    return f"{number(value)} %" if unit == "%" else number(value)


def machine_text(facts: Mapping[str, Any]) -> str:
    """The machine in a phrase."""
    parts = [str(facts[name]) for name in ("host", "processor") if facts.get(name)]
    parts += [plural(int(facts["cores"]), "core")] if isinstance(facts.get("cores"), int) else []
    return ", ".join(parts) or "an unknown machine"


def machine_rows(facts: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The facts of a machine, for people."""
    rows = []
    for name, value in facts.items():
        if isinstance(value, int | float) and name == "memory":
            rows.append((name, quantity(float(value), "B")))
        else:
            rows.append((name, value if isinstance(value, str) else json.dumps(value)))
    return rows


def csv(runs: pd.DataFrame) -> str:
    """The run table as CSV, without the columns that nothing reports."""
    kept = [name for name in runs.columns if name not in METRICS or runs[name].notna().any()]
    return str(runs[kept].to_csv(index=False, lineterminator="\n"))


def folder_of(name: str, taken: set[str]) -> PurePosixPath:
    """Where an experiment's page lies: its name, made safe to be a path, and told apart from those taken already."""
    parts = [re.sub(r"[^\w.-]+", "-", part).strip(".-") for part in name.split("/")]
    path = "/".join(part[:80] for part in parts if part) or "experiment"
    unique, copy = path, 2
    while unique.lower() in taken:
        unique, copy = f"{path}-{copy}", copy + 1
    taken.add(unique.lower())
    return PurePosixPath("pages") / unique


def verdict_groups(detail: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """The groups a verdict stands on: (which, verdict, statement); none where there is only one."""
    groups = detail.get("groups") or []
    rows = []
    for group in groups if len(groups) > 1 else ():
        which = ", ".join(setting(leaf, value) for leaf, value in group.get("parameters", {}).items())
        rows.append((which or "all points", str(group.get("verdict", "")), str(group.get("statement", ""))))
    return rows
