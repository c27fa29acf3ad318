"""A broad phase without the pairs that a scene ignores."""

from __future__ import annotations

from numpy.typing import ArrayLike

from harness.arrays import Pairs
from harness.broadphase.pairs import BroadPhase
from harness.scene.ignored_pairs import without


def asked_about(broad_phase: BroadPhase, ignored: Pairs) -> BroadPhase:
    """The broad phase as it is if nothing is ignored; else without the ignored pairs."""
    return WithoutIgnored(broad_phase, ignored) if len(ignored) else broad_phase


class WithoutIgnored:
    """A broad phase whose close pairs are those that are not ignored.

    Parameters
    ----------
    broad_phase : BroadPhase
    ignored : (m, 2) int array, i < j, sorted

    Attributes
    ----------
    pair_tests : pairs put to the sphere test so far; one that is ignored may be among them
    """

    def __init__(self, broad_phase: BroadPhase, ignored: Pairs) -> None:
        self._broad_phase, self._ignored, self.pair_tests = broad_phase, ignored, 0
        if hasattr(broad_phase, "cells_per_body"):
            self.cells_per_body = broad_phase.cells_per_body

    def close_pairs(self, positions: ArrayLike) -> Pairs:
        """As `BroadPhase.close_pairs`, less the ignored."""
        close = self._broad_phase.close_pairs(positions)
        self.pair_tests = self._broad_phase.pair_tests
        return without(close, self._ignored)
