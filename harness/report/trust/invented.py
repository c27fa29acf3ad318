"""Experiments with invented times, as the report reads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

import numpy as np
import pandas as pd

from harness.report.experiment import ExperimentPage
from harness.report.family import Family
from harness.report.trust.noise import MachineNoise, Times
from harness.store.records import ControlRecord, ExperimentRecord, PointRow, SweepRecord

CLOCK = "pair_seconds"
SWEEP = SweepRecord(1, "", "", "", None, "", "", {}, {})


@dataclass(frozen=True)
class Invented:
    """An experiment: the true time of every method at every x.

    Parameters
    ----------
    xs : numbers of bodies
    times : (methods, xs), s
    repeats : of each point
    """

    xs: tuple[int, ...]
    times: Times
    repeats: int = 5

    def page(self, name: str, rng: np.random.Generator, noise: MachineNoise, family: Family | None) -> ExperimentPage:
        """The page of the experiment, measured once on a machine with this noise; with a control as a sweep has it."""
        methods, k = self.times.shape
        points = [(method, place) for method in range(methods) for place in range(k)]
        lengths = np.log(self.times).ravel()
        spread = float(np.ptp(lengths))
        lengths = (lengths - lengths.min()) / spread if spread > 1e-9 else np.tile(np.linspace(0.0, 1.0, k), methods)
        again = [(2 * repeat + 1) * len(points) // (2 * self.repeats) for repeat in range(self.repeats)]
        factors = noise.factors(rng, self.repeats, np.concatenate([lengths, lengths[again]]))
        measured = factors[:, : len(points)] * self.times.ravel()
        rows = [_row(name, self.xs, point, repeat) for point in points for repeat in range(self.repeats)]
        runs = pd.DataFrame(rows).assign(**{CLOCK: measured.T.ravel()})
        controls = [
            ControlRecord(
                f"{name}-{place}",
                repeat,
                "",
                {CLOCK: float(factors[repeat, len(points) + repeat] * self.times.flat[place])},
            )
            for repeat, place in enumerate(again)
        ]
        specification = {"swept": ["count", "algorithm"], "report": {"x": "count", "y": [CLOCK]}}
        listed = tuple(PointRow(f"{name}-{place}", _leaves(self.xs, point)) for place, point in enumerate(points))
        record = ExperimentRecord(name, name, None, "", specification, listed, (), (), SWEEP)
        return ExperimentPage(record, runs, PurePosixPath(name), controls if self.repeats >= 5 else (), family=family)


def report(experiments: Sequence[Invented], rng: np.random.Generator, noise: MachineNoise) -> list[ExperimentPage]:
    """The pages of a report of all of these."""
    pages: list[ExperimentPage] = []
    family = Family(lambda: [(page.record, page.measured) for page in pages])
    pages += [found.page(f"e{place}", rng, noise, family) for place, found in enumerate(experiments)]
    return pages


def names_a_winner(page: ExperimentPage) -> bool:
    """Whether a finding of the page says that one method costs less than another."""
    return any(
        phrase in sentence
        for sentence in page.findings.sentences
        for phrase in ("ahead of", "has the lowest", "has a lower")
    )


def _leaves(xs: Sequence[int], point: tuple[int, int]) -> dict[str, object]:
    method, place = point
    return {"backend": "fcl", "algorithm": f"method {method}", "shape": "sphere", "count": xs[place]}


def _row(name: str, xs: Sequence[int], point: tuple[int, int], repeat: int) -> dict[str, object]:
    method, place = point
    number = method * len(xs) + place
    head = {
        "experiment": name,
        "point": f"{name}-{number}",
        "repeat": repeat,
        "status": "ok",
        "reason": None,
        "sweep": 1,
    }
    return {**head, "timing_grade": True, "machine": "", **_leaves(xs, point)}
