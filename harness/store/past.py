"""A metric over all sweeps: every run ever made, not the newest alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.store.connection import as_input_error
from harness.store.history import reading
from harness.store.selections import EXPERIMENT_OF_POINT


@dataclass(frozen=True)
class PastRun:
    """A run that ended well, and its metric.

    Parameters
    ----------
    machine : fingerprint of where it ran
    sweep : number
    experiment : that lists its point now, else one that lists the same parameters; "" where none does
    timing_grade : whether its clocks may be compared with others
    """

    machine: str
    sweep: int
    experiment: str
    parameters: Mapping[str, Any]
    value: float
    timing_grade: bool


def past_runs(path: str | Path, metric: str) -> list[PastRun]:
    """Every run that reports a metric, in the order in which they were made.

    Raises
    ------
    InputError
        The file is missing, empty, damaged, another program's, or of another schema version.
    """
    with reading(path) as connection, as_input_error(Path(path)):
        points = connection.execute(f"SELECT point.id, parameters, {EXPERIMENT_OF_POINT} FROM point").fetchall()
        rows = connection.execute(
            "SELECT fingerprint, sweep, point, value, timing_grade FROM run JOIN machine ON machine.id = run.machine "
            "JOIN metric ON metric.run = run.id WHERE status = 'ok' AND name = ? AND value IS NOT NULL ORDER BY run.id",
            (metric,),
        ).fetchall()
    # another version of the program has measured the same parameters under another key
    names = {text: name for _, text, name in points if name is not None}
    text_of = {point: text for point, text, _ in points}
    parameters = {text: json.loads(text) for text in text_of.values()}
    return [
        PastRun(
            machine, sweep, names.get(text_of[point], ""), parameters[text_of[point]], value, timing_grade=bool(grade)
        )
        for machine, sweep, point, value, grade in rows
    ]
