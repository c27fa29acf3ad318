"""What the page of an experiment is made of: its record and runs, arranged, and what was found in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

import pandas as pd

from harness.measure.metrics import METRICS
from harness.report.arrange import arrange
from harness.report.atlas import AtlasPart
from harness.report.backends.correctness import Correctness
from harness.report.criteria import refusals
from harness.report.family import Family
from harness.report.figure import Figure, figures_of
from harness.report.findings import Findings, findings
from harness.report.machine import machine_text
from harness.report.published import PublishedRow, published_rows
from harness.report.quantity import leaf_text, plural
from harness.report.ranking import Growth, growth
from harness.report.replay import Replay, replay_of
from harness.report.series import Arrangement
from harness.store.records import ControlRecord, ExperimentRecord

# Exponents are fitted for what the experiment asks for and for these counts, which have no noise.
_COUNTS = ("pair_tests", "box_tests", "narrow_tests", "predictions", "events")
_MOST_VALUES = 6


@dataclass(frozen=True, eq=False)
class ExperimentPage:
    """All that sections and figures of the page stand on.

    Parameters
    ----------
    record : of the experiment
    runs : rows of the run table that belong to it
    folder : where the page lies below the report
    controls : of its points
    conditions : of the machines while its runs went on
    known : what comparisons at its poses have found
    all_pages : those of all experiments, this one among them
    family : the comparisons of all of them; None where this one stands alone
    surveyed : what engines were found to say of its families of poses
    database : the results file, where a replay may be kept
    """

    record: ExperimentRecord
    runs: pd.DataFrame
    folder: PurePosixPath
    controls: Sequence[ControlRecord] = ()
    conditions: Sequence[Mapping[str, float]] = ()
    known: Correctness = field(default_factory=Correctness)
    all_pages: Sequence[ExperimentPage] = ()
    database: str | Path | None = None
    family: Family | None = None
    surveyed: Sequence[AtlasPart] = ()

    @property
    def href(self) -> str:
        """The page, from the pages at the top."""
        return f"{self.folder}/index.html"

    @property
    def up(self) -> str:
        """The folder of the report, from this page."""
        return "../" * len(self.folder.parts)

    @cached_property
    def measured(self) -> Arrangement:
        """Its points as series, before it is known at which level two of them are told apart."""
        return arrange(self.record, self.runs, self.controls, self.known)

    @cached_property
    def arrangement(self) -> Arrangement:
        """Its points as series."""
        family = self.family or Family(lambda: [(self.record, self.measured)])
        return replace(self.measured, level=family.level)

    @cached_property
    def growths(self) -> list[Growth]:
        """Exponents of its metrics, and of the counts that change."""
        medians = {name: {point.median(name) for point in self.arrangement.points} for name in _COUNTS}
        counts = [name for name, values in medians.items() if sum(value > 0 for value in values) > 1]
        return growth(self.arrangement, tuple(dict.fromkeys((*self.arrangement.metrics, *counts))))

    def compares(self, entry: Growth) -> bool:
        """Whether a growth is of what the page compares: of several series the first metric, of a lone one all."""
        return len(self.arrangement.series) == 1 or entry.metric == self.arrangement.metrics[0]

    @cached_property
    def findings(self) -> Findings:
        """What it found, in sentences."""
        return findings(self.record, self.arrangement, self.growths, self.surveyed)

    @cached_property
    def figures(self) -> dict[str, list[Figure]]:
        """Its figures, by the section that they stand in."""
        return figures_of("experiment", self)

    @cached_property
    def published(self) -> list[PublishedRow]:
        """Published rows beside ours."""
        return published_rows(self.record.name, self.record.specification.get("published") or {}, self.arrangement)

    @cached_property
    def replay(self) -> Replay | None:
        """Its replay, where one was recorded."""
        return None if self.database is None else replay_of(self.database, self.record)

    @property
    def summary(self) -> str:
        """What is swept, how often, where: one line."""
        parts = []
        for leaf in self.record.specification.get("swept") or ():
            values = list({leaf_text(point.parameters.get(leaf)): 0 for point in self.arrangement.points})
            listed = ", ".join(values) if len(values) <= _MOST_VALUES else f"{values[0]} … {values[-1]}"
            parts.append(f"{leaf} {listed}" + (f" ({len(values)} values)" if len(values) > _MOST_VALUES else ""))
        repeats = sorted({int(count) for count in self.runs.groupby("point").size()}) if len(self.runs) else [0]
        each = plural(repeats[0], "repeat") if len(repeats) == 1 else f"{repeats[0]} to {repeats[-1]} repeats"
        points = plural(len(self.record.points), "point")
        return "; ".join([*parts, f"{points}, {each} each, on {machine_text(self.record.sweep.machine)}"])

    @property
    def failed(self) -> int:
        """How many runs failed; those that were refused as expected did not."""
        return int((self.runs["status"] != "ok").sum()) - refusals(self.record, self.runs)

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


def csv(runs: pd.DataFrame) -> str:
    """The run table as CSV, without the columns that nothing reports."""
    reported = runs.notna().any()
    kept = [name for name in runs.columns if name not in METRICS or reported[name]]
    return str(runs[kept].to_csv(index=False, lineterminator="\n"))
