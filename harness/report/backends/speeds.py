"""Speed beside correctness: what a frame costs with each method, where being wrong costs the rank."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from harness.report.backends.correctness import Correctness
from harness.report.methods import methods_of
from harness.report.quantity import number, plural, scale
from harness.report.table import Column, Entry, Table, plain, words
from harness.vocabulary import MethodName

SPEED = "pair_seconds_per_frame"
_NOTE = (
    "CPU time of pair detection a frame, medians, poses included; the fastest of those that are right is bold. A "
    "method that was proven wrong on this shape, or failed, is struck through and has no rank; nor has one that was "
    "compared with no other."
)

# What tells the scenes of a table apart: values of leaves.
Place = tuple[Any, ...]


def speed_table(name: str, runs: pd.DataFrame, known: Correctness) -> Table | None:
    """The methods of an experiment, a column a scene; None where there is nothing to choose between.

    Parameters
    ----------
    name : of the experiment
    runs : of all experiments
    known : how right each method is
    """
    if SPEED not in runs.columns:
        return None
    mine = runs[(runs["experiment"] == name) & (runs["status"] == "ok") & runs[SPEED].notna()]
    if mine.empty or mine["backend"].nunique() < 2:
        return None
    scenes = [leaf for leaf in ("count", "packing") if mine[leaf].nunique() > 1]
    medians = _medians(mine, scenes)
    unit = scale(list(medians.values()), "s")
    methods = sorted({method for _, method in medians})
    columns = [Column("Method", numeric=False)]
    entries: dict[MethodName, list[Entry]] = {method: [] for method in methods}
    for place in sorted({place for place, _ in medians}):
        columns.append(Column(_scene_text(scenes, place), unit.symbol))
        right = [seconds for (at, method), seconds in medians.items() if at == place and known.is_right(method)]
        best = min(right) if len(right) > 1 else math.nan
        for method in methods:
            seconds = medians.get((place, method), math.nan)
            mark = "best" if seconds == best and known.is_right(method) else ""
            text = "not run" if math.isnan(seconds) else unit.text(seconds)
            entries[method].append(Entry(text, mark=mark, struck=known.is_wrong(method), sort=plain(seconds)))
    columns.append(Column("Correctness", numeric=False))
    rows = tuple((words(_label(method, methods)), *entries[method], _correctness(method, known)) for method in methods)
    return Table(name, _NOTE, tuple(columns), rows)


def _medians(runs: pd.DataFrame, scenes: Sequence[str]) -> dict[tuple[Place, MethodName], float]:
    """s, of every scene and method."""
    found: dict[tuple[Place, MethodName], list[float]] = defaultdict(list)
    places = zip(*(runs[leaf] for leaf in scenes), strict=True) if scenes else [()] * len(runs)
    for place, method, seconds in zip(places, methods_of(runs), runs[SPEED], strict=True):
        found[place, method].append(float(seconds))
    return {key: float(np.median(values)) for key, values in found.items()}


def _label(method: MethodName, methods: Sequence[MethodName]) -> str:
    """Backend and algorithm, and what else tells it from the others."""
    leaves = [leaf for place, leaf in enumerate(method) if place < 2 or len({other[place] for other in methods}) > 1]
    return ", ".join(leaves)


def _correctness(method: MethodName, known: Correctness) -> Entry:
    if known.is_wrong(method):
        return words("", flag=f"wrong {plural(known.wrong[method], 'time')}")
    if not known.is_right(method):
        return words("not compared")
    return words(f"never wrong in {plural(known.verdicts[method], 'verdict')}")


def _scene_text(leaves: Sequence[str], values: Sequence[Any]) -> str:
    said = []
    for leaf, value in zip(leaves, values, strict=True):
        said.append(f"packing {float(f'{value:.2g}'):g}" if leaf == "packing" else f"{number(value)} bodies")
    return ", ".join(said) or "a frame"
