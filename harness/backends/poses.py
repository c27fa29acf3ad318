"""Poses as libraries want them, and answers as the contract wants them: what several adapters need alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.protocol import ImpactTimes, NearPairs

# Relative: by how much more than a gap or a way spheres are grown, so that rounding loses no pair.
SLACK = 1e-9


class UniformMotion(NamedTuple):
    """How bodies move through a frame: at constant velocity and constant spin.

    Attributes
    ----------
    positions, quaternions : (n, 3) m and (n, 4) unit, w x y z, at the start
    velocities, spins : (n, 3) m/s and rad/s, in the world's axes
    duration : s
    """

    positions: Floats
    quaternions: Floats
    velocities: Floats
    spins: Floats
    duration: float

    def at(self, time: float) -> tuple[Floats, Floats]:
        """Positions and quaternions so many seconds after the start."""
        from harness.backends.rotations import rotations_at  # half a second that others need not spend

        everybody = np.arange(len(self.positions))
        turned = rotations_at(self, everybody, np.full(len(everybody), time))
        return self.positions + time * self.velocities, turned.as_quat()[:, [3, 0, 1, 2]]

    def middle(self) -> Floats:
        """(n, 3) m, of the centres, halfway through the frame."""
        return self.positions + 0.5 * self.duration * self.velocities

    def swept_radii(self, radii: Floats) -> Floats:
        """(n,) m: radii of spheres around `middle` that hold spheres of these radii throughout the frame.

        Each is grown by the way of the fastest body, so that they change only when that does.
        """
        speed = float(np.linalg.norm(self.velocities, axis=1).max(initial=0.0))
        return (radii + 0.5 * self.duration * speed) * (1.0 + SLACK)

    def steps(self, largest_turn: float) -> Floats:
        """Times from 0 to `duration`, s, evenly spaced, between which no body turns by more than an angle, rad."""
        spin = float(np.linalg.norm(self.spins, axis=1).max(initial=0.0))
        return np.linspace(0.0, self.duration, max(1, int(np.ceil(spin * self.duration / largest_turn))) + 1)


def require_finite(*poses: Floats) -> None:
    """Raises ValueError for a pose that is not finite, which libraries answer with a crash or a false hit."""
    if not all(np.isfinite(part).all() for part in poses):
        raise ValueError("a pose is not finite")


def near_radii(radii: Floats, within: float) -> Floats:
    """(n,) m: radii of spheres that touch wherever bodies in spheres of these radii are `within` apart or nearer, m."""
    return (radii + 0.5 * within) * (1.0 + SLACK)


def near_pairs(pairs: Pairs, gaps: Floats, points: Floats | None, within: float) -> NearPairs:
    """The pairs whose gap is at most `within`, from all that were asked about.

    Parameters
    ----------
    pairs : (k, 2) int array, sorted
    gaps : (k,) float array, m; 0 or below where two bodies touch
    points : (k, 2, 3) float array, m, or None
    within : m
    """
    near = gaps <= within
    gaps = np.maximum(gaps[near], 0.0)
    if points is None:
        return NearPairs(pairs[near], gaps, None)
    return NearPairs(pairs[near], gaps, np.where((gaps > 0.0)[:, None, None], points[near], np.nan))


def impact_times(found: Sequence[tuple[int, int, float]], duration: float) -> ImpactTimes:
    """The answer that has these i, j and times, s, in any order; a time that rounding put past the end is the end."""
    ordered = sorted(found)
    pairs = np.array([(i, j) for i, j, _ in ordered], np.int64).reshape(-1, 2)
    return ImpactTimes(pairs, np.array([min(max(time, 0.0), duration) for *_, time in ordered], np.float64))
