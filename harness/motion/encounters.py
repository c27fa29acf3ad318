"""When the bounding spheres of folded paths touch (`response: none`): every encounter, in closed form.

A path folded at the walls is straight from fold to fold. Between two folds a pair is a point passing a sphere, whose
times are the roots of a quadratic, with the discriminant as a cross product so that they keep their digits from afar.
Folds are numbered and their times computed, never stepped to, so that nothing adds up.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import floor, inf

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.kernel import kernel
from harness.measure.contacts import Contacts, of_spheres
from harness.motion.kinematics import Flight
from harness.narrowphase.spheres import passage
from harness.scene.bodies import Bodies
from harness.scene.box import Box

# Straight pieces of all pairs together up to which every pair is looked at over the whole duration (about a second).
FEW_PIECES = 5e6
# Ends of two pieces of one encounter that are no further apart, in ulps of the duration, are one moment.
SAME_MOMENT = 64.0


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
        Into how many parts the duration is cut; in each, only pairs near one another are looked at. Chosen where left
        out; the answer is the same.
    margin : float
        By how much of its radius each sphere is taken larger where it meets another, though not where it meets a wall.

    Returns
    -------
    Contacts
        Of spheres: each encounter is a contact.
    """
    flight, radii = Flight(bodies, box, folded=True, turning=False), bodies.radii * (1.0 + margin)
    paths = Paths(bodies, box)
    cuts = np.linspace(0.0, duration, (windows or _windows(bodies, paths.room, duration)) + 1)
    parts = [
        paths.touching(pairs, radii, begin, end)
        for begin, end, pairs in _near(bodies, radii, box, flight, cuts)
        if len(pairs)
    ]  # fmt: skip
    pairs = np.concatenate([part[0] for part in parts]) if parts else np.empty((0, 2), np.int64)
    begin = np.concatenate([part[1] for part in parts]) if parts else np.empty(0)
    end = np.concatenate([part[2] for part in parts]) if parts else np.empty(0)
    return of_spheres(duration, *_joined(pairs, begin, end, SAME_MOMENT * np.spacing(duration)))


def _windows(bodies: Bodies, room: Floats, duration: float) -> int:
    """One for all pairs at once, or as many as let the typical body fly its size in each."""
    speeds = np.linalg.norm(bodies.velocities, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        folds = np.nan_to_num(np.abs(bodies.velocities) * duration / (2.0 * room), posinf=0.0).clip(0.0)
    pieces = (len(bodies) - 1) * (len(bodies) / 2 + folds.sum())
    if pieces <= FEW_PIECES:
        return 1
    return max(1, int(np.ceil(np.median(speeds) * duration / bodies.sizes.mean())))


def _near(
    bodies: Bodies, radii: Floats, box: Box, flight: Flight, cuts: Floats
) -> Iterator[tuple[float, float, Pairs]]:
    """The pairs that can touch between two cuts, and those cuts.

    A folded path never strays further than its speed allows from where it is in the middle of the window.
    """
    if len(cuts) == 2:
        first, second = np.triu_indices(len(bodies), 1)
        yield cuts[0], cuts[1], np.column_stack([first, second]).astype(np.int64)
        return
    reach = np.linalg.norm(bodies.velocities, axis=1) * (cuts[1] - cuts[0]) / 2
    grid = HierarchicalGrid((radii + reach) * (1.0 + 1e-9), box)
    for begin, end in pairwise(cuts.tolist()):
        flight.move_to((begin + end) / 2)
        yield begin, end, grid.close_pairs(flight.positions)


class Paths:
    """All folded paths, ready to be held against each other pair by pair.

    Attributes
    ----------
    room : (n, 3) float array, m: how far from the middle each centre can come
    """

    def __init__(self, bodies: Bodies, box: Box) -> None:
        velocities = Flight(bodies, box, folded=True, turning=False).velocities
        room = box.half - bodies.radii[:, None]
        free = room > 0.0  # a body as large as the box stays in the middle
        self._origins, self._velocities = np.where(free, bodies.positions, 0.0), np.where(free, velocities, 0.0)
        self.room = np.where(free, room, 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead = np.where(self._velocities > 0.0, self.room, -self.room)
            first = (ahead - self._origins) / self._velocities
            self._first = np.where(self._velocities == 0.0, inf, first)
            self._period = np.where(self._velocities == 0.0, inf, 2.0 * self.room / np.abs(self._velocities))

    def pieces(self, i: int, j: int, begin: float, end: float) -> Iterator[tuple[float, float, Floats, Floats]]:
        """The straight pieces of a pair's motion in a window.

        Yields
        ------
        From when until when (s), and of both bodies the places at its beginning (2, 3) m and velocities (2, 3) m/s.
        """
        now, pair = begin, np.array([i, j])
        while True:
            places, velocities, later = _straight(
                pair, now, self._origins, self._velocities, self.room, self._first, self._period
            )
            yield now, min(later, end), places, velocities
            if later >= end:
                return
            now = later

    def touching(self, pairs: Pairs, radii: Floats, begin: float, end: float) -> tuple[Pairs, Floats, Floats]:
        """The pairs (k, 2), and from when until when they touch within [begin, end]; a pair as often as it does."""
        size = 4 * len(pairs) + 64
        while True:
            which, since, until = np.empty(size, np.int64), np.empty(size), np.empty(size)
            found = _touching(
                pairs, begin, end, self._origins, self._velocities, self.room, self._first, self._period, radii,
                which, since, until,
            )  # fmt: skip
            if found <= size:
                return pairs[which[:found]], since[:found], until[:found]
            size = found


def _joined(pairs: Pairs, begin: Floats, end: Floats, slack: float) -> tuple[Pairs, Floats, Floats]:
    """Times of one pair that follow upon each other without a gap become one; sorted by pair and time."""
    if not len(pairs):
        return pairs, begin, end
    order = np.lexsort((begin, pairs[:, 1], pairs[:, 0]))
    pairs, begin, end = pairs[order], begin[order], end[order]
    same: Flags = (pairs[1:] == pairs[:-1]).all(axis=1) & (begin[1:] <= end[:-1] + slack)
    starts = np.flatnonzero(np.concatenate([[True], ~same]))
    return pairs[starts], begin[starts], np.maximum.reduceat(end, starts)


@kernel
def _touching(
    pairs: Pairs,
    begin: float,
    end: float,
    origins: Floats,
    velocities: Floats,
    room: Floats,
    first: Floats,
    period: Floats,
    radii: Floats,
    which: Ints,
    since: Floats,
    until: Floats,
) -> int:
    """How many touches there are; those that have room are written down."""
    count = 0
    legs = np.empty(6, np.int64)
    folds = np.empty(6)
    for k in range(len(pairs)):
        i, j = pairs[k]
        for side in range(6):
            body, axis = (i, side) if side < 3 else (j, side - 3)
            legs[side] = _leg(first[body, axis], period[body, axis], begin)
            folds[side] = _fold_time(first[body, axis], period[body, axis], legs[side] + 1)
        reach = radii[i] + radii[j]
        now = begin
        while True:
            later = min(end, folds.min())
            gap = np.empty(3)
            velocity = np.empty(3)
            for axis in range(3):
                x, v = _place(origins, velocities, room, first, period, i, axis, legs[axis], now)
                y, w = _place(origins, velocities, room, first, period, j, axis, legs[axis + 3], now)
                gap[axis] = y - x
                velocity[axis] = w - v
            enter, leave = passage(gap, velocity, reach)
            enter, leave = max(enter, 0.0), min(leave, later - now)
            if enter <= leave:
                if count < len(which):
                    which[count], since[count] = k, now + enter
                    until[count] = later if leave == later - now else now + leave
                count += 1
            if later >= end:
                break
            for side in range(6):
                body, axis = (i, side) if side < 3 else (j, side - 3)
                while folds[side] <= later:
                    legs[side] += 1
                    folds[side] = _fold_time(first[body, axis], period[body, axis], legs[side] + 1)
            now = later
    return count


@kernel
def _straight(
    pair: Ints, time: float, origins: Floats, velocities: Floats, room: Floats, first: Floats, period: Floats
) -> tuple[Floats, Floats, float]:
    """Places (2, 3) and velocities (2, 3) of a pair at a time, and when the next of them folds."""
    places, speeds, later = np.empty((2, 3)), np.empty((2, 3)), inf
    for side in range(2):
        body = pair[side]
        for axis in range(3):
            leg = _leg(first[body, axis], period[body, axis], time)
            places[side, axis], speeds[side, axis] = _place(
                origins, velocities, room, first, period, body, axis, leg, time
            )
            later = min(later, _fold_time(first[body, axis], period[body, axis], leg + 1))
    return places, speeds, later


@kernel
def _leg(first: float, period: float, time: float) -> int:
    """The number of folds up to and including a time."""
    if time < first:
        return 0
    leg = 1 + floor((time - first) / period)
    while _fold_time(first, period, leg + 1) <= time:
        leg += 1
    while leg > 0 and _fold_time(first, period, leg) > time:
        leg -= 1
    return leg


@kernel
def _fold_time(first: float, period: float, number: int) -> float:
    return first + (number - 1) * period if number > 1 else first


@kernel
def _place(
    origins: Floats,
    velocities: Floats,
    room: Floats,
    first: Floats,
    period: Floats,
    body: int,
    axis: int,
    leg: int,
    time: float,
) -> tuple[float, float]:
    """Coordinate and velocity of a body on one axis, on this leg of its path."""
    v = velocities[body, axis]
    if leg == 0:
        return origins[body, axis] + v * time, v
    # the wall ahead is met by odd folds, the one behind by even ones
    wall = room[body, axis] if (v > 0.0) == (leg % 2 == 1) else -room[body, axis]
    back = -v if leg % 2 == 1 else v
    return wall + back * (time - _fold_time(first[body, axis], period[body, axis], leg)), back
