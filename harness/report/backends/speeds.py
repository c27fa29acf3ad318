"""Speed beside correctness: what a frame costs with each method, where being wrong costs the rank."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from harness.measure.resolution import Resolution
from harness.report.backends.correctness import Correctness
from harness.report.experiment import ExperimentPage
from harness.report.point import MeasuredPoint
from harness.report.quantity import number, plural, scale
from harness.report.ranking import tell_apart, unranked
from harness.report.table import Column, Entry, Table, plain, words
from harness.vocabulary import MethodName

SPEED = "pair_seconds_per_frame"
_NOTE = (
    "CPU time of pair detection a frame, medians, poses included. Of those that are right the fastest is bold, and "
    "what cannot be told from it. A method that was proven wrong on this shape, or failed, is struck through and has "
    "no rank; nor has one that was compared with no other."
)

# What tells the scenes of a table apart: values of leaves.
Place = tuple[float, ...]


def speed_table(page: ExperimentPage, known: Correctness) -> Table | None:
    """The methods of an experiment, a column a scene; None where there is nothing to choose between.

    Parameters
    ----------
    page : of the experiment
    known : how right each method is
    """
    points = [point for point in page.arrangement.points if point.summary(SPEED) is not None]
    if len({point.parameters["backend"] for point in points}) < 2:
        return None
    scenes = [leaf for leaf in ("count", "packing") if len({_scene_value(point, leaf) for point in points}) > 1]
    measured: dict[Place, dict[MethodName, list[MeasuredPoint]]] = defaultdict(lambda: defaultdict(list))
    for point in points:
        place = tuple(_scene_value(point, leaf) for leaf in scenes)
        measured[place][MethodName.of(point.parameters)].append(point)
    medians = {
        (place, method): float(np.median(np.concatenate([point.values(SPEED) for point in found])))
        for place, methods in measured.items()
        for method, found in methods.items()
    }
    unit = scale(list(medians.values()), "s")
    methods = sorted({method for _, method in medians})
    columns = [Column("Method", numeric=False)]
    entries: dict[MethodName, list[Entry]] = {method: [] for method in methods}
    reasons: dict[str, None] = {}  # why scenes have no fastest method
    for place in sorted(measured):
        columns.append(Column(_scene_text(scenes, place), unit.symbol))
        right = {method: found for method, found in measured[place].items() if known.is_right(method)}
        best, why_not = _fastest(right, page.arrangement.resolution(SPEED))
        reasons |= {why_not: None} if why_not else {}
        for method in methods:
            seconds = medians.get((place, method), math.nan)
            mark = "best" if method in best else ""
            text = "not run" if math.isnan(seconds) else unit.text(seconds)
            entries[method].append(Entry(text, mark=mark, struck=known.is_wrong(method), sort=plain(seconds)))
    columns.append(Column("Correctness", numeric=False))
    rows = tuple((words(_label(method, methods)), *entries[method], _correctness(method, known)) for method in methods)
    note = _NOTE + (f" Nothing is bold for {', or '.join(reasons)}." if reasons else "")
    return Table(page.record.name, note, tuple(columns), rows)


def _fastest(
    measured: Mapping[MethodName, Sequence[MeasuredPoint]], resolution: Resolution
) -> tuple[Collection[MethodName], str]:
    """Of the methods of a scene the fastest, with those not to be told from it; or why none is called that."""
    if len(measured) < 2:
        return (), ""
    if any(len(points) > 1 for points in measured.values()):
        return (), "several scenes in one column"
    points = {method: found[0] for method, found in measured.items()}
    best = min(points, key=lambda method: points[method].median(SPEED))
    distinctions = {
        method: tell_apart(point, points[best], SPEED, resolution) for method, point in points.items() if method != best
    }
    why_not = unranked(distinctions.values())
    return ((), why_not) if why_not else ({best, *(m for m, found in distinctions.items() if found != "apart")}, "")


def _scene_value(point: MeasuredPoint, leaf: str) -> float:
    value = point.parameters.get(leaf)
    return float(value) if isinstance(value, int | float) else -1.0


def _label(method: MethodName, methods: Sequence[MethodName]) -> str:
    """Backend and algorithm, and what else tells it from the others."""
    differing = [
        name
        for name in MethodName._fields
        if name in ("backend", "algorithm") or len({getattr(other, name) for other in methods}) > 1
    ]
    return ", ".join(getattr(method, name) for name in differing)


def _correctness(method: MethodName, known: Correctness) -> Entry:
    if known.is_wrong(method):
        return words("", flag=f"wrong {plural(known.wrong[method], 'time')}, in {', '.join(known.where[method])}")
    if not known.is_right(method):
        return words("not compared")
    part = ", compared in part" if method in known.in_part else ""
    return words(f"never wrong in {plural(known.verdicts[method], 'verdict')}{part}")


def _scene_text(leaves: Sequence[str], values: Sequence[float]) -> str:
    parts = []
    for leaf, value in zip(leaves, values, strict=True):
        parts.append(f"packing {float(f'{value:.2g}'):g}" if leaf == "packing" else f"{number(value)} bodies")
    return ", ".join(parts) or "a frame"
