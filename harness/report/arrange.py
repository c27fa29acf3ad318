"""How an experiment's points become series: which leaf goes along x, which make series, which a panel."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from harness.measure.noise import Control, controls_of
from harness.report.backends.correctness import Correctness
from harness.report.disputes import disputed
from harness.report.methods import method_label
from harness.report.point import METHOD, MeasuredPoint, numbers_of
from harness.report.quantity import leaf_text
from harness.report.series import Arrangement, Series, hashable, in_a_panel, is_number
from harness.report.styles import styles_of
from harness.report.words import leaf_label
from harness.store.records import ControlRecord, ExperimentRecord
from harness.vocabulary import METHOD_LEAVES, MethodName

MOST_IN_A_PANEL = 6
DEFAULT_METRICS = ("pair_seconds", "box_seconds")


def arrange(
    record: ExperimentRecord,
    runs: pd.DataFrame,
    controls: Sequence[ControlRecord] = (),
    known: Correctness = Correctness(),  # noqa: B008  nobody changes it
) -> Arrangement:
    """Arrange an experiment's points.

    Parameters
    ----------
    record : of the experiment
    runs : rows of the run table that belong to it
    controls : of its points
    known : what comparisons at its poses have found
    """
    points = _measured(record, runs, known)
    unsure = disputed(record, points, known)
    points = [replace(point, disputed=point.row.key in unsure) for point in points] if unsure else points
    report: Mapping[str, Any] = record.specification.get("report") or {}
    swept = [leaf for leaf in record.specification.get("swept") or () if _spread(points, leaf) > 1]
    x: str | None
    panel_leaf: str | None
    if report.get("map"):
        x, panel_leaf, others = _mapped(points, swept, report["map"])
    else:
        x = _x_leaf(points, swept, report.get("x"))
        others = [leaf for leaf in swept if leaf != x and not _follows(points, leaf, x)]
        panel_leaf = _panel_leaf(points, others)
        if panel_leaf and x and _crowds_alike(points, panel_leaf, x):
            others = ["packing" if leaf == panel_leaf else leaf for leaf in others]
            panel_leaf = "packing"
    lines: dict[str, list[MeasuredPoint]] = {}
    for point in points:
        # of a map's y, which may be derived, the value as it is written, without what is rounded off it
        row = leaf_text(point.value(panel_leaf)) if report.get("map") else ""
        lines.setdefault(row + _key(point, others), []).append(point)
    names = [leaf for leaf in others if leaf != panel_leaf]
    styles = styles_of(
        {_label(members[0].parameters, names): MethodName.of(members[0].parameters) for members in lines.values()}
    )
    series = []
    for members in lines.values():
        first = members[0].parameters
        label = _label(first, names)
        members = sorted(members, key=lambda point: _order(point.value(x))) if x else members
        series.append(
            Series(
                label,
                styles[label],
                leaf_label(panel_leaf, in_a_panel(panel_leaf, first.get(panel_leaf))) if panel_leaf else "",
                tuple(members),
                tuple(point.value(x) for point in members) if x else tuple(None for _ in members),
            )
        )
    values = {hashable(point.value(x)): point.value(x) for point in points} if x else {}
    y = report.get("y") or _timed(points)
    return Arrangement(
        x,
        tuple(sorted(values.values(), key=_order)),
        tuple(series),
        panel_leaf,
        (y,) if isinstance(y, str) else tuple(y),
        _controls(runs, controls),
    )


def _timed(points: Sequence[MeasuredPoint]) -> tuple[str, ...]:
    """What is shown unless an experiment says: the clocks of what is tested at all; where nothing is, both."""
    found = tuple(name for name in DEFAULT_METRICS if any((point.values(name) > 0.0).any() for point in points))
    return found or DEFAULT_METRICS


def _measured(record: ExperimentRecord, runs: pd.DataFrame, known: Correctness) -> list[MeasuredPoint]:
    """Its points with their runs; the numbers of all of them are taken from the table at once."""
    ordered = runs.sort_values(["repeat", "sweep"], kind="stable")
    numbers, good = numbers_of(ordered), (ordered["status"] == "ok").to_numpy()
    rows_of = ordered.groupby("point", sort=False).indices
    points = []
    for row in record.points:
        rows = np.asarray(rows_of.get(row.key, ()), dtype=np.intp)
        wrong = known.is_wrong(MethodName.of(row.parameters))
        points.append(MeasuredPoint(row, ordered.iloc[rows], wrong, numbers=(numbers, rows[good[rows]])))
    return points


def _mapped(
    points: Sequence[MeasuredPoint], swept: Sequence[str], axes: Mapping[str, str]
) -> tuple[str, str, list[str]]:
    """The leaves of a map: x, panels by y, and the others that neither of the two settles."""
    x, y = axes["x"], axes["y"]
    fields = {(_key(point, (x,)), leaf_text(point.value(y))) for point in points}

    def settled(leaf: str) -> bool:
        pairs = {(_key(point, (x,)), leaf_text(point.value(y)), _key(point, (leaf,))) for point in points}
        return len(pairs) == len(fields)

    return x, y, [leaf for leaf in swept if leaf not in (x, y) and not settled(leaf)]


def _controls(runs: pd.DataFrame, controls: Sequence[ControlRecord]) -> dict[str, Control]:
    """The control of every clock that tells one."""
    clocks = sorted({metric for record in controls for metric in record.metrics if metric in runs.columns})
    good = runs[runs["status"] == "ok"]
    places = zip(good["point"], good["repeat"], good["machine"], strict=True)
    # not `itertuples`, which in pandas 2 has no rows where there is no column
    measured = good[clocks].to_numpy().tolist()
    first = {place: dict(zip(clocks, values, strict=True)) for place, values in zip(places, measured, strict=True)}
    return controls_of(first, [((record.point, record.repeat, record.machine), record.metrics) for record in controls])


def _x_leaf(points: Sequence[MeasuredPoint], swept: Sequence[str], wanted: str | None) -> str | None:
    if wanted and _spread(points, wanted) > 0:
        return wanted
    numeric = [leaf for leaf in swept if all(is_number(point.parameters.get(leaf)) for point in points)]
    # where no leaf is a number, what the method is tells more as series than along x
    x = next(iter(numeric or [leaf for leaf in swept if leaf not in METHOD_LEAVES] or swept), None)
    return METHOD if x in ("backend", "algorithm") and {"backend", "algorithm"} <= set(swept) else x


def _panel_leaf(points: Sequence[MeasuredPoint], others: Sequence[str]) -> str | None:
    scene = [leaf for leaf in others if leaf not in METHOD_LEAVES]
    mixed = 0 < len(scene) < len(others)  # methods are compared on the same scene
    if len(others) < 2 or not (mixed or len({_key(point, others) for point in points}) > MOST_IN_A_PANEL):
        return None
    scene = scene or list(others)
    return min(scene, key=lambda leaf: (_spread(points, leaf) > 8, -_spread(points, leaf)))


def _crowds_alike(points: Sequence[MeasuredPoint], leaf: str, x: str) -> bool:
    """Whether each value of the leaf has one x, as boxes do that grow with the bodies, where a packing has several."""

    def xs_of(panel: str) -> list[int]:
        found: dict[str, set[str]] = {}
        for point in points:
            found.setdefault(_key(point, (panel,)), set()).add(_key(point, (x,)))
        return [len(xs) for xs in found.values()]

    scenes = {(_key(point, (leaf,)), _key(point, (x,)), _key(point, ("packing",))) for point in points}
    places = {place[1:] for place in scenes}
    return max(xs_of(leaf)) == 1 < min(xs_of("packing")) and len(scenes) == len(places)


def _label(parameters: Mapping[str, Any], leaves: Sequence[str]) -> str:
    """The swept leaves' values; where none is left, what the method is."""
    named = leaves or [leaf for leaf in ("backend", "algorithm") if leaf in parameters]
    return method_label(parameters, named) or "this scene"


def _follows(points: Sequence[MeasuredPoint], leaf: str, x: str | None) -> bool:
    """Whether x determines the leaf, as `faces` does the mesh: it is then no series of its own."""
    if x is None:
        return False
    return len({_key(point, (x, leaf)) for point in points}) == _spread(points, x)


def _spread(points: Sequence[MeasuredPoint], leaf: str) -> int:
    """How many values the leaf takes."""
    return len({_key(point, (leaf,)) for point in points if leaf == METHOD or leaf in point.parameters})


def _key(point: MeasuredPoint, leaves: Sequence[str]) -> str:
    return json.dumps([in_a_panel(leaf, point.value(leaf)) for leaf in leaves], sort_keys=True)


def _order(value: object) -> tuple[int, float]:
    """Numbers by size; anything else keeps the order of the file (sorting is stable)."""
    return (0, float(value)) if isinstance(value, int | float) and not isinstance(value, bool) else (1, 0.0)
