"""Paths folded at the walls of the box (`response: none`): where a body is on which straight piece of its path.

Folds are numbered and their times computed, never stepped to, so that no rounding adds up. On each axis a body meets
the wall ahead of it first, then both walls by turns; between two folds of either body a pair moves straight.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, inf
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel
from harness.motion.kinematics import Trajectory
from harness.scene.bodies import Bodies
from harness.scene.box import Box


class FoldedPaths(NamedTuple):
    """The paths of all bodies, axis by axis; (n, 3) float arrays, which kernels take as one argument.

    Parameters
    ----------
    origins : m, at time 0
    velocities : m/s, after time 0
    inner_half : m, how far from the middle of the box each centre can come
    first_fold : s, when the wall ahead is met, inf where a body does not move
    period : s between two folds
    """

    origins: Floats
    velocities: Floats
    inner_half: Floats
    first_fold: Floats
    period: Floats


class StraightPiece(NamedTuple):
    """A piece of a pair's motion without a fold.

    Parameters
    ----------
    begin, end : s
    places : (2, 3) float array, m, at the beginning
    velocities : (2, 3) float array, m/s
    """

    begin: float
    end: float
    places: Floats
    velocities: Floats


def folded_paths(bodies: Bodies, box: Box) -> FoldedPaths:
    """The paths of bodies that the box alone reflects, where their bounding spheres touch it.

    Parameters
    ----------
    bodies : at time 0
    box : Box
    """
    velocities = Trajectory(bodies, box, folded=True, turning=False).velocities
    inner_half = box.half - bodies.radii[:, None]
    free = inner_half > 0.0  # a body as large as the box stays in the middle
    origins, velocities = np.where(free, bodies.positions, 0.0), np.where(free, velocities, 0.0)
    inner_half = np.where(free, inner_half, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = np.where(velocities > 0.0, inner_half, -inner_half)
        first_fold = np.where(velocities == 0.0, inf, (ahead - origins) / velocities)
        period = np.where(velocities == 0.0, inf, 2.0 * inner_half / np.abs(velocities))
    return FoldedPaths(origins, velocities, inner_half, first_fold, period)


def straight_pieces(paths: FoldedPaths, i: int, j: int, begin: float, end: float) -> Iterator[StraightPiece]:
    """The straight pieces of a pair's motion in a window, from fold to fold.

    Parameters
    ----------
    paths : FoldedPaths
    i, j : the pair
    begin, end : s
    """
    now, pair = begin, np.array([i, j])
    while True:
        places, velocities, next_fold = _pair_at(paths, pair, now)
        yield StraightPiece(now, min(next_fold, end), places, velocities)
        if next_fold >= end:
            return
        now = next_fold


@kernel
def _pair_at(paths: FoldedPaths, pair: Ints, time: float) -> tuple[Floats, Floats, float]:
    """Places (2, 3) m and velocities (2, 3) m/s of a pair at a time, and when the next of them folds, s."""
    places, velocities, next_fold = np.empty((2, 3)), np.empty((2, 3)), inf
    for side in range(2):
        body = pair[side]
        for axis in range(3):
            leg = leg_at(paths, body, axis, time)
            places[side, axis], velocities[side, axis] = state_on_leg(paths, body, axis, leg, time)
            next_fold = min(next_fold, fold_time(paths, body, axis, leg + 1))
    return places, velocities, next_fold


@kernel
def leg_at(paths: FoldedPaths, body: int, axis: int, time: float) -> int:
    """The number of folds of a body on one axis up to and including a time (s)."""
    first: float = paths.first_fold[body, axis]
    if time < first:
        return 0
    period: float = paths.period[body, axis]
    leg = 1 + floor((time - first) / period)
    while fold_time(paths, body, axis, leg + 1) <= time:
        leg += 1
    while leg > 0 and fold_time(paths, body, axis, leg) > time:
        leg -= 1
    return leg


@kernel
def fold_time(paths: FoldedPaths, body: int, axis: int, number: int) -> float:
    """When a body folds on one axis for the first (1), second (2), … time, s."""
    first: float = paths.first_fold[body, axis]
    period: float = paths.period[body, axis]
    return first + (number - 1) * period if number > 1 else first


@kernel
def state_on_leg(paths: FoldedPaths, body: int, axis: int, leg: int, time: float) -> tuple[float, float]:
    """Coordinate (m) and velocity (m/s) of a body on one axis, on this leg of its path."""
    v = paths.velocities[body, axis]
    if leg == 0:
        return paths.origins[body, axis] + v * time, v
    # the wall ahead is met by odd folds, the one behind by even ones
    half = paths.inner_half[body, axis]
    wall = half if (v > 0.0) == (leg % 2 == 1) else -half
    back = -v if leg % 2 == 1 else v
    return wall + back * (time - fold_time(paths, body, axis, leg)), back
