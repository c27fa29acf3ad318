"""What a query found, frame after frame: the answers that errors are measured on and a replay shows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from harness.arrays import Floats, Ints, Pairs


@dataclass(frozen=True, eq=False)
class NearAnswers:
    """The pairs that were near in the frames of a run.

    Parameters
    ----------
    frames : (k,) int array, ascending; frame f is at f·dt
    pairs : (k, 2) int array
    gaps : (k,) float array, m; 0 where the two touch, nan where the query has none
    points : (k, 2, 3) float array, m, in the world: the nearest points, or of a query without gaps two that are near;
        nan where there are none
    """

    frames: Ints
    pairs: Pairs
    gaps: Floats
    points: Floats


@dataclass
class NearLog:
    """Near pairs appended frame by frame."""

    frames: list[Ints] = field(default_factory=list)
    pairs: list[Pairs] = field(default_factory=list)
    gaps: list[Floats] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)

    def add(self, frame: int, pairs: Pairs, gaps: Floats | None, points: Floats | None) -> None:
        """Append what a frame answered: (k, 2) pairs, and (k,) gaps and (k, 2, 3) points where there are any."""
        count = len(pairs)
        self.frames.append(np.full(count, frame, np.int64))
        self.pairs.append(pairs)
        self.gaps.append(np.full(count, np.nan) if gaps is None else gaps)
        self.points.append(np.full((count, 2, 3), np.nan) if points is None else points)

    def answers(self) -> NearAnswers:
        """All of them."""
        return NearAnswers(
            np.concatenate([np.empty(0, np.int64), *self.frames]),
            np.concatenate([np.empty((0, 2), np.int64), *self.pairs]),
            np.concatenate([np.empty(0), *self.gaps]),
            np.concatenate([np.empty((0, 2, 3)), *self.points]),
        )
