"""Published numbers beside ours, and what they say against one another.

Where every pair is tested each frame and every body against six walls, F frames of N bodies give

    P = F N (N - 1) / 2   object/object tests,      W = 6 F N   object/wall tests,

so that N = 2 P / (W / 6) + 1 and F = W / (6 N) can be read back from the two counts and held against what is printed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from harness.measure.metrics import METRICS
from harness.report.point import MeasuredPoint
from harness.report.quantity import leaf_text
from harness.report.series import Arrangement
from harness.report.words import leaf_label

_EXACT = 0.005  # a recovered number of bodies further than this from a whole one is none
_SLACK = 0.05  # frames counted against frames timed: further apart than this is a contradiction
_ALIKE = 3  # equal numbers that make a row a repetition of another


@dataclass(frozen=True)
class PublishedRow:
    """One published row: where it stands, its leaf values, its numbers, and our point with the series it belongs to."""

    experiment: str
    leaves: Mapping[str, Any]
    numbers: Mapping[str, float]
    point: MeasuredPoint | None
    series: str
    style: int

    @property
    def name(self) -> str:
        """The row's place in its table: "count 5"."""
        return ", ".join(leaf_label(leaf, value) for leaf, value in self.leaves.items()) or "the only row"

    def ours(self, metric: str) -> float:
        """Our median of the metric, nan where there is none."""
        return self.point.median(metric) if self.point else math.nan

    def parameter(self, leaf: str) -> Any:
        """A leaf as it is printed, else as our point has it."""
        return self.leaves.get(leaf, self.point.parameters.get(leaf) if self.point else None)


@dataclass(frozen=True)
class Recovered:
    """What a row's two test counts say about its run: bodies and frames, with what is printed (None: nothing)."""

    row: PublishedRow
    bodies: float
    printed: float | None
    frames: float
    frames_timed: float | None

    @property
    def whole(self) -> bool:
        """Whether the counts fit a whole number of bodies at all."""
        return abs(self.bodies - round(self.bodies)) <= _EXACT

    @property
    def bodies_agree(self) -> bool:
        """Whether the number of bodies recovered is the one printed."""
        return self.printed is None or (self.whole and round(self.bodies) == self.printed)

    @property
    def frames_agree(self) -> bool:
        """Whether as many frames were counted as the printed rate makes in the simulated time."""
        return self.frames_timed is None or math.isclose(self.frames, self.frames_timed, rel_tol=_SLACK)


@dataclass(frozen=True)
class Repetition:
    """Two published rows with the same numbers, which were measured apart: `same` and `differing` name metrics."""

    first: PublishedRow
    second: PublishedRow
    same: tuple[str, ...]
    differing: tuple[str, ...]


def published_rows(name: str, published: Mapping[str, Any], arrangement: Arrangement) -> list[PublishedRow]:
    """The rows of a `published:` block, each with our points at its leaf values: of several series, or none."""
    rows = []
    for given in published.get("rows") or ():
        numbers = {key: float(value) for key, value in given.items() if key in METRICS and _number(value) is not None}
        leaves = {key: value for key, value in given.items() if key not in METRICS}
        ours = [
            (series, point)
            for series in arrangement.series
            for point in series.points
            if all(_same(point.parameters.get(leaf), value) for leaf, value in leaves.items())
        ]
        rows += [PublishedRow(name, leaves, numbers, point, series.label, series.style) for series, point in ours] or [
            PublishedRow(name, leaves, numbers, None, "", 0)
        ]
    return rows


def metrics_of(rows: Sequence[PublishedRow]) -> list[str]:
    """The metrics that the rows print, in the order of their first row."""
    return list(dict.fromkeys(metric for row in rows for metric in row.numbers))


def distinct(rows: Sequence[PublishedRow]) -> list[PublishedRow]:
    """The published rows themselves, once each, however many of our series they meet."""
    return list({(row.experiment, row.name, tuple(row.numbers.items())): row for row in reversed(rows)}.values())[::-1]


def recovered(rows: Sequence[PublishedRow]) -> list[Recovered]:
    """Bodies and frames from the test counts of every row that prints both."""
    found = []
    for row in distinct(rows):
        pairs, walls = row.numbers.get("pair_tests"), row.numbers.get("box_tests")
        if not pairs or not walls:
            continue
        bodies = 2 * pairs / (walls / 6) + 1
        rate, duration = row.numbers.get("frames_per_second"), _number(row.parameter("duration"))
        found.append(
            Recovered(
                row=row,
                bodies=bodies,
                printed=_number(row.parameter("count")),
                frames=walls / (6 * bodies),
                frames_timed=rate * duration if rate and duration else None,
            )
        )
    return found


def repetitions(rows: Sequence[PublishedRow], elsewhere: Sequence[PublishedRow] = ()) -> list[Repetition]:
    """Rows that repeat another row of theirs, or of another experiment, though they print other leaf values.

    Parameters
    ----------
    rows : of one experiment
    elsewhere : of the others; only repetitions that touch `rows` are returned
    """
    own, others = distinct(rows), distinct(elsewhere)
    pairs = [*combinations(own, 2), *((first, second) for first in own for second in others)]
    found = []
    for first, second in pairs:
        shared = [metric for metric in first.numbers if metric in second.numbers]
        same = tuple(metric for metric in shared if first.numbers[metric] == second.numbers[metric])
        if len(same) >= _ALIKE and not _same_scene(first, second):
            found.append(Repetition(first, second, same, tuple(metric for metric in shared if metric not in same)))
    return found


def _same_scene(first: PublishedRow, second: PublishedRow) -> bool:
    """Whether both rows are of the same scene, so that equal numbers are as they should be."""
    if first.point is None or second.point is None:
        return False
    leaves = ("count", "mesh", "shape", "box_ratio", "box", "faces", "size")
    mine, theirs = first.point.parameters, second.point.parameters
    return all(_same(mine.get(leaf), theirs.get(leaf)) for leaf in leaves)


def _same(ours: object, published: object) -> bool:
    left, right = _number(ours), _number(published)
    if left is not None and right is not None:
        return math.isclose(left, right, rel_tol=1e-9)
    return ours == published or (ours is not None and leaf_text(ours) == leaf_text(published))


def _number(value: object) -> float | None:
    """A number, or a fraction written as text; None for anything else."""
    if isinstance(value, bool):
        return None
    if isinstance(value, int | float):
        return float(value)
    if isinstance(value, str):
        above, _, below = value.partition("/")
        try:
            return float(above) / float(below or 1)
        except (ValueError, ZeroDivisionError):
            return None
    return None
