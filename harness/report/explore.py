"""The table of all points of all experiments, to be searched: a row a point, a column a leaf or a metric.

The page shows every row and every column as it stands. A script, where there is one, filters and arranges them; for it
a column has a name, which is that of the leaf or the metric everywhere, and an entry its exact value.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from harness.measure.metrics import METRICS
from harness.report.experiment import ExperimentPage
from harness.report.point import MeasuredPoint
from harness.report.quantity import THIN, leaf_text, quantity
from harness.report.series import hashable, is_number
from harness.report.styles import style_of
from harness.report.words import metric_title, metric_unit
from harness.vocabulary import METHOD_LEAVES, MethodName

# Of what a page shows of its own accord: what most people ask for first. Others are a click away.
_FIRST = (
    "count", "packing", "mesh", "shape", "query", "dt", "tolerance",
    "run_seconds", "pair_seconds", "simulated_per_second", "pair_tests", "pair_hits", "missed_hits", "time_error",
)  # fmt: skip
_LEAVES_FIRST = ("backend", "algorithm", *_FIRST)


@dataclass(frozen=True)
class ExploredColumn:
    """A column: its name in files and in the address, and what stands above it.

    Parameters
    ----------
    kind : "leaf" by which rows are filtered and grouped, or "metric"
    unit : of the numbers that are its values, "" for none
    first : whether it is shown before anybody has chosen columns, as far as it tells rows apart
    """

    name: str
    title: str
    kind: str
    numeric: bool
    unit: str = ""
    first: bool = False


@dataclass(frozen=True)
class ExploredEntry:
    """What a row says in a column: as people read it, and where that is not exact, the number itself."""

    text: str
    value: str = ""


@dataclass(frozen=True)
class ExploredRow:
    """A point: its experiment, where that has its page, its method with its colour, and the entries of all columns."""

    experiment: str
    href: str
    method: str
    style: int
    status: str
    entries: Sequence[ExploredEntry]


def explored(pages: Sequence[ExperimentPage]) -> tuple[list[ExploredColumn], list[ExploredRow]]:
    """The columns behind experiment, method and status, and a row for every point of these experiments."""
    points = [(page, point) for page in pages for point in page.arrangement.points]
    columns = [*_leaves([point for _, point in points]), *_metrics([point for _, point in points])]
    return columns, [_row(page, point, columns) for page, point in points]


def _leaves(points: Sequence[MeasuredPoint]) -> Iterator[ExploredColumn]:
    """Leaves that tell two points apart, those that are asked for most first."""
    values: dict[str, set[object]] = {}
    for point in points:
        for leaf, value in point.parameters.items():
            values.setdefault(leaf, set()).add(hashable(value))
    names = [leaf for leaf in _LEAVES_FIRST if leaf in values]
    for leaf in [*names, *(leaf for leaf in values if leaf not in names)]:
        told_apart = len(values[leaf]) > 1 or any(leaf not in point.parameters for point in points)
        if told_apart or leaf in METHOD_LEAVES:
            numeric = all(is_number(value) for value in values[leaf] if value is not None)
            yield ExploredColumn(leaf, leaf, "leaf", numeric, first=leaf in _FIRST)


def _metrics(points: Sequence[MeasuredPoint]) -> Iterator[ExploredColumn]:
    names = [name for name in _FIRST if name in METRICS]
    for name in [*names, *(name for name in METRICS if name not in names)]:
        if METRICS[name].tabulated and any(len(point.values(name)) for point in points):
            unit = metric_unit(name)
            yield ExploredColumn(name, metric_title(name), "metric", True, unit if unit != "1" else "", name in _FIRST)


def _row(page: ExperimentPage, point: MeasuredPoint, columns: Sequence[ExploredColumn]) -> ExploredRow:
    method = MethodName.of(point.parameters)
    entries = [
        _leaf(point.parameters, column) if column.kind == "leaf" else _metric(point, column) for column in columns
    ]
    return ExploredRow(page.record.name, page.href, method.label, style_of(method), _status(point), entries)


def _status(point: MeasuredPoint) -> str:
    """How its runs ended, and where they did, whether they may be believed."""
    if not point.statuses:
        return "not run"
    ended = sorted(point.statuses - {"ok"})
    if ended:
        return ", ".join(ended)
    return "wrong" if point.is_wrong else "disputed" if point.disputed else "ok"


def _leaf(parameters: Mapping[str, Any], column: ExploredColumn) -> ExploredEntry:
    if column.name not in parameters or parameters[column.name] is None:
        return ExploredEntry("")
    value = parameters[column.name]
    return _number(leaf_text(value), float(value)) if column.numeric else ExploredEntry(leaf_text(value))


def _metric(point: MeasuredPoint, column: ExploredColumn) -> ExploredEntry:
    if not len(point.values(column.name)):
        return ExploredEntry("")
    median = point.median(column.name)
    return _number(quantity(median, column.unit or "1"), median)


def _number(text: str, value: float) -> ExploredEntry:
    try:
        exact = float(text.replace(THIN, "").replace("−", "-")) == value
    except ValueError:
        exact = False
    return ExploredEntry(text, "" if exact else repr(value))
