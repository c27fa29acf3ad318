"""A point of an experiment with what its runs have measured."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from harness.measure.statistics import Summary, median, summary
from harness.store.records import PointRow
from harness.vocabulary import METHOD_LEAVES, MethodName

METHOD = "method"
"""What goes along x where an experiment varies backend and algorithm together: it is no leaf, but both of them."""

BUSY_ABOVE = 1.2
"""Elapsed over CPU time from which on the machine was busy with something else."""

_NOTHING = np.empty(0)

Numbers = Mapping[str, npt.NDArray[np.float64]]
"""Columns of numbers, each by the name of what it holds."""


def numbers_of(runs: pd.DataFrame) -> Numbers:
    """The columns of numbers of a table of runs, NaN where a run has none."""
    numbers = runs.select_dtypes("number")
    return dict(zip(numbers.columns, numbers.to_numpy(np.float64, na_value=math.nan).T, strict=True))


@dataclass(frozen=True, eq=False)
class MeasuredPoint:
    """One point of an experiment with all its runs, failed ones included.

    Parameters
    ----------
    row : as it is stored
    runs : a row a run, by repeat
    proven_wrong : whether its method was proven wrong at poses of this experiment, or failed at them
    disputed : whether other methods saw other hits of the same motion, and it is not known who is right
    numbers : of a table that its good runs are rows of, by repeat, and which; where they are at hand
    """

    row: PointRow
    runs: pd.DataFrame
    proven_wrong: bool = False
    disputed: bool = False
    numbers: tuple[Numbers, npt.NDArray[np.intp]] | None = None

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Its leaves, and what is derived from them."""
        return self.row.parameters

    @property
    def scene(self) -> dict[str, Any]:
        """Those of its leaves that are not the method's."""
        return {leaf: value for leaf, value in self.parameters.items() if leaf not in METHOD_LEAVES}

    def value(self, x: str | None) -> Any:
        """Its place along x: the value of a leaf, or the method's label."""
        return MethodName.of(self.parameters).label if x == METHOD else self.parameters.get(x or "")

    @cached_property
    def good(self) -> pd.DataFrame:
        """The runs that came to their end."""
        ended: pd.DataFrame = self.runs[self.runs["status"] == "ok"]
        return ended

    @cached_property
    def statuses(self) -> frozenset[str]:
        """How its runs ended; none where there are none."""
        return frozenset(self.runs["status"])

    def values(self, metric: str) -> npt.NDArray[np.float64]:
        """The metric of every good run that reports it, by repeat."""
        if metric not in self._values:
            columns, rows = self.numbers or (self._numbers, slice(None))
            values = columns[metric][rows] if metric in columns else _NOTHING
            finite = np.isfinite(values)
            self._values[metric] = values if finite.all() else values[finite]
        return self._values[metric]

    def by_place(self, metric: str) -> dict[tuple[int, str], float]:
        """The metric of every good run that reports it, by repeat and machine.

        To be paired with another point's: times of two machines are not compared.
        """
        if metric not in self._by_place:
            columns, rows = self.numbers or (self._numbers, slice(None))
            found = zip(self._places, columns[metric][rows].tolist(), strict=True) if metric in columns else ()
            self._by_place[metric] = {place: value for place, value in found if math.isfinite(value)}
        return self._by_place[metric]

    def summary(self, metric: str) -> Summary | None:
        """Median and interval of the metric, None where no good run reports it."""
        if metric not in self._summaries:
            values = self.values(metric)
            self._summaries[metric] = summary(values) if len(values) else None
        return self._summaries[metric]

    def median(self, metric: str) -> float:
        """Median of the metric, nan where no good run reports it."""
        if metric not in self._medians:  # most are asked for nothing else, which takes a fifth of the time
            self._medians[metric] = median(self.values(metric))
        return self._medians[metric]

    @property
    def elapsed_ratio(self) -> float:
        """Elapsed over CPU time of its runs, nan where it is not known."""
        cpu = self.median("run_seconds")
        return self.median("run_seconds_elapsed") / cpu if cpu > 0 else math.nan

    @cached_property
    def disagrees(self) -> bool:
        """Whether a run's hits differ from the reference's."""
        return any(bool((self.values(metric) > 0).any()) for metric in ("missed_hits", "extra_hits"))

    @property
    def is_wrong(self) -> bool:
        """Whether its answers are known to be wrong: such a point is shown struck through, and never ranked."""
        return self.proven_wrong or self.disagrees

    @property
    def can_be_ranked(self) -> bool:
        """Whether nothing speaks against its answers."""
        return not self.is_wrong and not self.disputed

    @property
    def replaces_shape(self) -> bool:
        """Whether its method puts another shape in place of that of the bodies, as its plan warns."""
        return any(str(warning).startswith("APPROXIMATION") for warning in self.row.plan.get("warnings") or ())

    @cached_property
    def _numbers(self) -> Numbers:
        return numbers_of(self.good)

    @cached_property
    def _places(self) -> list[tuple[int, str]]:
        """Repeat and machine of every good run."""
        return [(int(r), str(m)) for r, m in zip(self.good["repeat"], self.good["machine"], strict=True)]

    @cached_property
    def _by_place(self) -> dict[str, dict[tuple[int, str], float]]:
        return {}

    @cached_property
    def _values(self) -> dict[str, npt.NDArray[np.float64]]:
        return {}

    @cached_property
    def _medians(self) -> dict[str, float]:
        return {}

    @cached_property
    def _summaries(self) -> dict[str, Summary | None]:
        return {}
