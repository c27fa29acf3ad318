"""Speed beside correctness: what a frame costs with each method, where being wrong costs the rank."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from harness.report.quantity import number, plural, scale
from harness.report.table import Column, Entry, Table, plain, words

SPEED = "pair_seconds_per_frame"
_NOTE = (
    "CPU time of pair detection a frame, medians, poses included; the fastest of those that are right is bold. A "
    "backend that was proven wrong on this shape, or failed, is struck through and has no rank."
)

Method = tuple[str, str]


def speed_table(
    name: str, runs: pd.DataFrame, wrong: Mapping[tuple[str, str], int], tallies: Sequence[Mapping[str, Any]]
) -> Table | None:
    """The methods of an experiment, a column a scene; None where there is nothing to choose between.

    Parameters
    ----------
    name : of the experiment
    runs : of all experiments
    wrong : by backend and shape, how often it was proven wrong
    tallies : what was compared
    """
    if SPEED not in runs.columns:
        return None
    mine = runs[(runs["experiment"] == name) & (runs["status"] == "ok") & runs[SPEED].notna()]
    if mine.empty or mine["backend"].nunique() < 2:
        return None
    shape = str(mine["shape"].iloc[0])
    scenes = [leaf for leaf in ("count", "packing") if mine[leaf].nunique() > 1]
    medians = mine.groupby([*scenes, "backend", "algorithm"], dropna=False)[SPEED].median().reset_index()
    unit = scale(list(medians[SPEED]), "s")
    methods: list[Method] = sorted(set(zip(medians["backend"], medians["algorithm"], strict=True)))
    places: list[tuple[Any, ...]] = list(dict.fromkeys(zip(*(medians[leaf] for leaf in scenes), strict=True)))
    columns = [Column("Method", numeric=False)]
    cells: dict[Method, list[Entry]] = {method: [] for method in methods}
    for place in places or [()]:
        here = medians
        for leaf, value in zip(scenes, place, strict=True):
            here = here[here[leaf] == value]
        columns.append(Column(_scene_text(scenes, place), unit.symbol))
        seconds = {(row.backend, row.algorithm): float(getattr(row, SPEED)) for row in here.itertuples(index=False)}
        right = [value for (backend, _), value in seconds.items() if (backend, shape) not in wrong]
        best = min(right) if len(right) > 1 else math.nan
        for method in methods:
            value = seconds.get(method, math.nan)
            struck = (method[0], shape) in wrong
            mark = "best" if value == best and not struck else ""
            text = unit.text(value) if method in seconds else "not run"
            cells[method].append(Entry(text, mark=mark, struck=struck, sort=plain(value)))
    columns.append(Column("Correctness", numeric=False))
    rows = tuple(
        (words(", ".join(method)), *cells[method], _correctness(method[0], shape, wrong, tallies)) for method in methods
    )
    return Table(name, _NOTE, tuple(columns), rows)


def _correctness(
    backend: str, shape: str, wrong: Mapping[tuple[str, str], int], tallies: Sequence[Mapping[str, Any]]
) -> Entry:
    count = wrong.get((backend, shape), 0)
    if count:
        return words("", flag=f"wrong {plural(count, 'time')}")
    met = [tally for tally in tallies if backend in tally["backends"] and tally["shape"] == shape]
    if not met:
        return words("not compared")
    return words(f"never wrong in {plural(sum(tally['verdicts'] for tally in met), 'verdict')}")


def _scene_text(leaves: Sequence[str], values: Sequence[Any]) -> str:
    said = []
    for leaf, value in zip(leaves, values, strict=True):
        said.append(f"packing {float(f'{value:.2g}'):g}" if leaf == "packing" else f"{number(value)} bodies")
    return ", ".join(said) or "a frame"
