"""When the bounding spheres of folded paths touch (`response: none`): every encounter, in closed form.

Between two folds a pair is a point passing a sphere, whose times are the roots of a quadratic, with the discriminant as
a cross product so that they keep their digits from afar.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.errors import InputError
from harness.kernel import kernel
from harness.motion.kinematics import Trajectory
from harness.narrowphase.spheres import passage
from harness.reference.contacts import Contacts
from harness.reference.folded_paths import FoldedPaths, fold_time, folded_paths, leg_at, state_on_leg
from harness.scene.bodies import Bodies
from harness.scene.box import Box

# Straight pieces of all pairs together up to which every pair is searched over the whole duration (about a second).
FEW_PIECES = 5e6
# Beyond this no contact is searched for: it would take hours, and soon no float could tell the times of folds apart.
MOST_FOLDS = 1e10
# A window costs as much as so many pieces of pairs, even if no pair is near within it.
PIECES_A_WINDOW = 2000
MOST_WINDOWS = 1e8
# Ends of two pieces of one encounter that are no further apart, in ulps of the duration, are one moment.
SAME_MOMENT = 64.0


class Encounters(NamedTuple):
    """Times during which the spheres of a pair touch.

    Parameters
    ----------
    pairs : (k, 2) int array, i < j; a pair stands here as often as it meets
    begin, end : (k,) float arrays, s
    """

    pairs: Pairs
    begin: Floats
    end: Floats


def sphere_contacts(
    bodies: Bodies, box: Box, duration: float, windows: int | None = None, margin: float = 0.0
) -> Contacts:
    """All contacts of the bounding spheres on their folded paths.

    Parameters
    ----------
    bodies : Bodies
        At time 0.
    box : Box
        That reflects the centres where the spheres touch it.
    duration : float
        s
    windows : int
        Into how many parts the duration is cut; in each, only pairs near one another are searched. Chosen where left
        out; the answer is the same.
    margin : float
        By how much of its radius each sphere is taken larger where it meets another, though not where it meets a wall.

    Returns
    -------
    Contacts
        Of spheres: each encounter is a contact.

    Raises
    ------
    InputError
        If the walls reflect bodies so often that contacts cannot be searched for.
    """
    paths, radii = folded_paths(bodies, box), bodies.radii * (1.0 + margin)
    cuts = np.linspace(0.0, duration, (windows or _windows(bodies, paths.inner_half, duration)) + 1)
    parts = [
        _encounters(paths, radii, window)
        for window in _near(bodies, radii, box, cuts)
        if len(window.pairs)
    ]  # fmt: skip
    found = Encounters(
        np.concatenate([part.pairs for part in parts]) if parts else np.empty((0, 2), np.int64),
        np.concatenate([part.begin for part in parts]) if parts else np.empty(0),
        np.concatenate([part.end for part in parts]) if parts else np.empty(0),
    )
    joined = _joined(found, SAME_MOMENT * np.spacing(duration))
    return Contacts.of_spheres(duration, joined.pairs, joined.begin, joined.end)


def _windows(bodies: Bodies, inner_half: Floats, duration: float) -> int:
    """One for all pairs at once, or as many as let the typical body move by its size in each."""
    speeds = np.linalg.norm(bodies.velocities, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        folds = np.nan_to_num(np.abs(bodies.velocities) * duration / (2.0 * inner_half), posinf=0.0).clip(0.0)
    pieces = (len(bodies) - 1) * (len(bodies) / 2 + folds.sum())
    if folds.sum() > MOST_FOLDS:
        raise InputError(
            f"walls reflect the bodies {folds.sum():.1g} times, of which the reference follows {MOST_FOLDS:.0g} at the "
            "most: take a shorter duration, slower bodies or a larger box"
        )
    if pieces <= FEW_PIECES:
        return 1
    wanted = np.ceil(np.median(speeds) * duration / bodies.sizes.mean())
    return int(min(max(1.0, wanted), pieces / PIECES_A_WINDOW, MOST_WINDOWS))


class _Window(NamedTuple):
    """A part of the duration (s), and the pairs (k, 2) that can touch within it."""

    begin: float
    end: float
    pairs: Pairs


def _near(bodies: Bodies, radii: Floats, box: Box, cuts: Floats) -> Iterator[_Window]:
    """The windows between cuts.

    A folded path is never farther than its speed allows from where it is in the middle of the window.
    """
    if len(cuts) == 2:
        first, second = np.triu_indices(len(bodies), 1)
        yield _Window(cuts[0], cuts[1], np.column_stack([first, second]).astype(np.int64))
        return
    trajectory = Trajectory(bodies, box, folded=True, turning=False)
    reach = np.linalg.norm(bodies.velocities, axis=1) * (cuts[1] - cuts[0]) / 2
    grid = HierarchicalGrid((radii + reach) * (1.0 + 1e-9), box)
    for begin, end in pairwise(cuts.tolist()):
        trajectory.move_to((begin + end) / 2)
        yield _Window(begin, end, grid.close_pairs(trajectory.positions))


def _encounters(paths: FoldedPaths, radii: Floats, window: _Window) -> Encounters:
    """The encounters within a window, cut to it."""
    size = 4 * len(window.pairs) + 64
    while True:
        found = _Found(np.empty(size, np.int64), np.empty(size), np.empty(size))
        count = _search(paths, radii, window, found)
        if count <= size:
            return Encounters(window.pairs[found.number[:count]], found.begin[:count], found.end[:count])
        size = count


def _joined(found: Encounters, slack: float) -> Encounters:
    """Times of one pair that follow upon each other within `slack` (s) become one; sorted by pair and time."""
    if not len(found.pairs):
        return found
    order = np.lexsort((found.begin, found.pairs[:, 1], found.pairs[:, 0]))
    pairs, begin, end = found.pairs[order], found.begin[order], found.end[order]
    same: Flags = (pairs[1:] == pairs[:-1]).all(axis=1) & (begin[1:] <= end[:-1] + slack)
    starts = np.flatnonzero(np.concatenate([[True], ~same]))
    return Encounters(pairs[starts], begin[starts], np.maximum.reduceat(end, starts))


class _Found(NamedTuple):
    """Room for encounters: the number of the pair in its window, and from when until when, s."""

    number: Ints
    begin: Floats
    end: Floats


@kernel
def _search(paths: FoldedPaths, radii: Floats, window: _Window, found: _Found) -> int:
    """How many encounters there are; those for which there is room are written down."""
    count = 0
    legs = np.empty(6, np.int64)
    folds = np.empty(6)
    for k in range(len(window.pairs)):
        i, j = window.pairs[k]
        for side in range(6):
            body, axis = (i, side) if side < 3 else (j, side - 3)
            legs[side] = leg_at(paths, body, axis, window.begin)
            folds[side] = fold_time(paths, body, axis, legs[side] + 1)
        reach = radii[i] + radii[j]
        now = window.begin
        while True:
            later = min(window.end, folds.min())
            gap = np.empty(3)
            velocity = np.empty(3)
            for axis in range(3):
                x, v = state_on_leg(paths, i, axis, legs[axis], now)
                y, w = state_on_leg(paths, j, axis, legs[axis + 3], now)
                gap[axis] = y - x
                velocity[axis] = w - v
            enter, leave = passage(gap, velocity, reach)
            enter, leave = max(enter, 0.0), min(leave, later - now)
            if enter <= leave:
                if count < len(found.number):
                    found.number[count], found.begin[count] = k, now + enter
                    found.end[count] = later if leave == later - now else now + leave
                count += 1
            if later >= window.end:
                break
            for side in range(6):
                body, axis = (i, side) if side < 3 else (j, side - 3)
                while folds[side] <= later:
                    legs[side] += 1
                    folds[side] = fold_time(paths, body, axis, legs[side] + 1)
            now = later
    return count
