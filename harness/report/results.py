"""All that a report is made from: the results file, read once, and what follows from all of it together."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

import pandas as pd

from harness.errors import InputError
from harness.report.accuracy.experiment import ExperimentAccuracy, accuracy_of
from harness.report.atlas import AtlasResults
from harness.report.backends.comparisons import Comparisons
from harness.report.backends.correctness import correctness, newest
from harness.report.experiment import ExperimentPage
from harness.report.family import Family
from harness.report.stability.matrix import Matrix, matrix
from harness.report.sweeps.difference import Difference
from harness.report.sweeps.page import newest_difference
from harness.report.truth import TruthResults
from harness.report.verdicts import worded
from harness.store.records import ComparisonRecord, ExperimentRecord
from harness.store.tables import comparisons, conditions, controls, experiments, machines, runs


@dataclass(frozen=True, eq=False)
class Results:
    """What a results file holds; each part is read or made when it is first asked for."""

    database: str | Path

    @cached_property
    def runs(self) -> pd.DataFrame:
        """The run table of all experiments."""
        table = runs(self.database)
        if lacking := [leaf for leaf in ("backend", "algorithm", "shape") if leaf not in table and len(table)]:
            raise InputError(f"{self.database}: is damaged: its points do not say their {lacking[0]}")
        texts = list(table.select_dtypes("string"))
        # as plain objects: rows of those are taken at a fraction of the cost
        plain: pd.DataFrame = table.astype(dict.fromkeys(texts, object)).copy()
        return plain

    @cached_property
    def records(self) -> list[ExperimentRecord]:
        """Every experiment, by name."""
        return [
            replace(
                record, expectations=tuple(map(worded, record.expectations)), claims=tuple(map(worded, record.claims))
            )
            for record in experiments(self.database)
        ]

    @cached_property
    def pages(self) -> list[ExperimentPage]:
        """The page of every experiment."""
        taken: set[str] = set()
        pages: list[ExperimentPage] = []
        for record in self.records:
            compared = [found for found in self.compared.records if found.experiment == record.name]
            pages.append(
                ExperimentPage(
                    record,
                    self.runs[self.runs["experiment"] == record.name],
                    folder_of(record.name, taken),
                    controls=controls(self.database, [record.name]),
                    conditions=conditions(self.database, record.name),
                    known=correctness(compared),
                    all_pages=pages,
                    database=self.database,
                    family=self.family,
                    surveyed=AtlasResults.of(Comparisons(compared)).parts,
                )
            )
        return pages

    @cached_property
    def family(self) -> Family:
        """All comparisons of the report."""
        return Family(lambda: [(page.record, page.measured) for page in self.pages])

    @cached_property
    def _compared(self) -> list[ComparisonRecord]:
        return comparisons(self.database)

    @cached_property
    def compared(self) -> Comparisons:
        """What was found of backends on the same poses."""
        return Comparisons(newest([record for record in self._compared if "truth" not in record.document]))

    @cached_property
    def truth(self) -> TruthResults:
        """What engines answered to sets of cases with proven times of impact."""
        return TruthResults([record for record in self._compared if "truth" in record.document])

    @cached_property
    def accuracy(self) -> list[ExperimentAccuracy]:
        """The experiments that measure errors against a reference."""
        return accuracy_of(self.pages)

    @cached_property
    def stability(self) -> Matrix | None:
        """Stiff and extreme cases against methods."""
        return matrix(self.pages)

    @cached_property
    def difference(self) -> Difference | None:
        """How the newest sweep differs from the one before."""
        return newest_difference(self.database)

    @cached_property
    def machines(self) -> Mapping[str, Mapping[str, Any]]:
        """The facts of every machine that something shown ran on, by its fingerprint."""
        used = {record.sweep.fingerprint for record in self.records}
        used = used.union(*(set(page.runs["machine"]) for page in self.pages))
        return {name: facts for name, facts in machines(self.database).items() if name in used}


def folder_of(name: str, taken: set[str]) -> PurePosixPath:
    """Where an experiment's page lies: its name, made safe to be a path, and another than those taken already."""
    parts = [re.sub(r"[^\w.-]+", "-", part).strip(".-") for part in name.split("/")]
    path = "/".join(part[:80] for part in parts if part) or "experiment"
    unique, copy = path, 2
    while unique.lower() in taken:
        unique, copy = f"{path}-{copy}", copy + 1
    taken.add(unique.lower())
    return PurePosixPath("pages") / unique
