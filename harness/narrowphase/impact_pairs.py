"""When the pairs of a frame begin to touch: every onset from one frame to the next, of spheres, hulls or surfaces.

A pair that touches at the start of a frame is followed until it parts, and one that does not is advanced to its next
contact, by the same searches that event-driven motion uses. So times are exact however long the frame is. A search for
a contact goes on to where either way turns: a pair which goes on as it did is searched once, and not in every frame.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeVar

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.kernel import inner, kernel
from harness.narrowphase.body_shapes import Hulls, Shapes, hull_of, shape_of
from harness.narrowphase.contact_end import ContactEnd, LastCrossing, end_of_hull_contact, followed_mesh_contact
from harness.narrowphase.contact_intervals import Onset, next_mesh_contact
from harness.narrowphase.frame_flights import (
    FrameFlights,
    flight_of_pair,
    fold,
    motion_in,
    pair_flight,
    until_fold,
)
from harness.narrowphase.free_flight import Motion
from harness.narrowphase.mesh_advancement import MeshShape
from harness.narrowphase.motion_impacts import near_impact
from harness.narrowphase.pair_states import (
    NOTHING_KNOWN,
    PAIR_STATE,
    PairState,
    PairStates,
    at_turn,
    keep,
    later,
    state_of,
)
from harness.narrowphase.spheres import passage
from harness.narrowphase.support import SupportMap
from harness.narrowphase.tree_pairs import DEPTH, ROOTS
from harness.narrowphase.vectors import dot, minus
from harness.narrowphase.verdicts import SearchVerdict

Solids = TypeVar("Solids")
Shape = TypeVar("Shape")

# By how much the tolerance of a search that was given up is raised before it is done again, and how many are done.
COARSER, MOST_SEARCHES = 10.0, 3
# How often a search for a contact is taken up where it was given up, at the same tolerance, before that.
MOST_RESUMED = 10


class PairsAsked(NamedTuple):
    """What is asked of a frame.

    Attributes
    ----------
    pairs : (k, 2) int array, sorted: all that can touch
    before : (m,) PairStates at the end of the last frame
    steady : (n,) bool array, the bodies that go on as in the last frame
    first : whether it is the first frame: a pair that touches at its start has not begun to in it
    tolerance : of the mean size of a pair, the gap at which bodies count as touching; of no effect on spheres
    """

    pairs: Pairs
    before: PairStates
    steady: Flags
    first: bool
    tolerance: float


class Onsets(NamedTuple):
    """What is found, written.

    Attributes
    ----------
    pairs : (m,) int array, which of the pairs asked about began to touch; ascending
    times : (m,) float array, s after the start of the frame
    states : (k,) PairStates at the end of the frame
    """

    pairs: Ints
    times: Floats
    states: PairStates


class OnsetCount(NamedTuple):
    """How many onsets there are, which may be more than there is room for, and how many pairs were given up."""

    onsets: int
    given_up: int


class NumberedPair(NamedTuple):
    """Pair k of those asked about, of bodies i and j."""

    k: int
    i: int
    j: int


class Piece(NamedTuple):
    """A straight piece of a pair's way.

    Attributes
    ----------
    begin, length : s, when it begins in the frame, and how much of it lies in the frame
    straight : s, how long the way is straight, which may be longer
    tolerance : m, the gap that counts as touching
    settled : whether a pair which touches at its start has begun to before
    """

    begin: float
    length: float
    straight: float
    tolerance: float
    settled: bool


class Followed(NamedTuple):
    """What is known of a pair, from the beginning of a piece on, when it has been followed through it.

    Attributes
    ----------
    state : PairState; it lasts to the end of the piece, or longer
    onsets : how many there are so far, of all pairs
    known : whether every search came to its end
    """

    state: PairState
    onsets: int
    known: bool


@kernel
def sphere_pair_onsets(asked: PairsAsked, flights: FrameFlights, found: Onsets) -> OnsetCount:
    """All onsets of spheres."""
    return pair_onsets(asked, flights, 0, found, spheres_in_piece)


@kernel
def hull_pair_onsets(asked: PairsAsked, flights: FrameFlights, hulls: Hulls, found: Onsets) -> OnsetCount:
    """All onsets of bodies that have these hulls."""
    return pair_onsets(asked, flights, hulls, found, hulls_in_piece)


@kernel
def mesh_pair_onsets(asked: PairsAsked, flights: FrameFlights, shapes: Shapes, found: Onsets) -> OnsetCount:
    """All onsets of bodies that have these surfaces."""
    return pair_onsets(asked, flights, shapes, found, surfaces_in_piece)


@inner
def pair_onsets(
    asked: PairsAsked,
    flights: FrameFlights,
    solids: Solids,
    found: Onsets,
    in_piece: Callable[[Solids, NumberedPair, Motion, Motion, Piece, Followed, Onsets], Followed],
) -> OnsetCount:
    """The onsets of all pairs, in order, given what follows a pair of the solids through a straight piece."""
    count, given_up, place = 0, 0, 0
    pair = pair_flight()
    for k in range(len(asked.pairs)):
        i, j = asked.pairs[k, 0], asked.pairs[k, 1]
        key = i << 32 | j
        while place < len(asked.before) and asked.before[place].key < key:
            place += 1
        state = state_of(asked.before, place, key)
        if not (asked.steady[i] and asked.steady[j]):
            state = at_turn(state)
        if state.until > flights.duration:
            keep(found.states, k, key, later(state, flights.duration))
            continue
        flight_of_pair(flights, i, j, pair)
        now = 0.0
        while True:
            straight = until_fold(flights, i, j, pair)
            wait = min(straight, flights.duration - now)
            a, b = motion_in(flights, i, pair, 0, now), motion_in(flights, j, pair, 1, now)
            tolerance = asked.tolerance * 0.5 * (a.size + b.size)
            piece = Piece(now, wait, straight, tolerance, asked.first and now == 0.0)
            followed = again_if_unknown(
                solids, NumberedPair(k, i, j), a, b, piece, Followed(state, count, True), found, in_piece
            )
            state, count = followed.state, followed.onsets
            given_up += not followed.known
            if now + wait >= flights.duration:
                break
            fold(flights, i, j, pair, wait)
            now += wait
            state = at_turn(state)
        keep(found.states, k, key, later(state, wait))
    return OnsetCount(count, given_up)


@inner
def again_if_unknown(
    solids: Solids,
    place: NumberedPair,
    a: Motion,
    b: Motion,
    piece: Piece,
    before: Followed,
    found: Onsets,
    in_piece: Callable[[Solids, NumberedPair, Motion, Motion, Piece, Followed, Onsets], Followed],
) -> Followed:
    """A pair through a piece, and on from where a search is given up at a larger tolerance.

    What was found before that stays, so that the time of a contact is no coarser because its end is hard to find. One
    whose end is not known even then is taken to touch through the piece: coplanar faces that slide over each other
    neither cross nor come apart.
    """
    after = before
    for _ in range(MOST_SEARCHES):
        after = in_piece(solids, place, a, b, piece, after, found)
        if after.known:
            break
        piece = Piece(piece.begin, piece.length, piece.straight, COARSER * piece.tolerance, piece.settled)
    return after


@kernel
def spheres_in_piece(
    nothing: int, place: NumberedPair, a: Motion, b: Motion, piece: Piece, before: Followed, found: Onsets
) -> Followed:
    """Spheres touch once in a straight piece, from a root of a quadratic to the next."""
    gap, drift = minus(b.position, a.position), minus(b.velocity, a.velocity)
    met = passage(gap, drift, 0.5 * (a.size + b.size))
    if not (met.enter <= piece.length and met.leave >= 0.0):
        return Followed(NOTHING_KNOWN, before.onsets, True)
    count = before.onsets
    # what touches at the start was reported before, unless rounding has delayed its beginning: then it approaches
    begins = met.enter > 0.0 or (not piece.settled and dot(gap, drift) < 0.0)
    if begins and not before.state.touches:
        count = write_onset(found, count, place.k, piece.begin + max(met.enter, 0.0))
    return Followed(PairState(met.leave >= piece.length, 0.0, False, ROOTS, 0.0, 0), count, True)


@kernel
def hulls_in_piece(
    hulls: Hulls, place: NumberedPair, a: Motion, b: Motion, piece: Piece, before: Followed, found: Onsets
) -> Followed:
    """Hulls, from contact to contact."""
    solids = hull_of(hulls, place.i), hull_of(hulls, place.j)
    return solids_in_piece(solids, place.k, a, b, piece, before, found, next_hull_onset, followed_hulls)


@kernel
def surfaces_in_piece(
    shapes: Shapes, place: NumberedPair, a: Motion, b: Motion, piece: Piece, before: Followed, found: Onsets
) -> Followed:
    """Surfaces, from contact to contact."""
    solids = shape_of(shapes, place.i), shape_of(shapes, place.j)
    return solids_in_piece(solids, place.k, a, b, piece, before, found, next_mesh_contact, followed_surfaces)


@kernel
def next_hull_onset(
    hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Onset:
    """When two hulls touch, at the beginning of a window or later."""
    found = near_impact(hull_a, hull_b, a, b, begin, end, tolerance)
    return Onset(found.verdict, found.time, ROOTS)


@inner
def followed_hulls(
    one: SupportMap, other: SupportMap, a: Motion, b: Motion, state: PairState, end: float, tolerance: float
) -> tuple[ContactEnd, PairState]:
    """Hulls that touch, followed on from until when that is known."""
    return end_of_hull_contact(one, other, a, b, state.until, end, tolerance), state


@inner
def followed_surfaces(
    one: MeshShape, other: MeshShape, a: Motion, b: Motion, state: PairState, end: float, tolerance: float
) -> tuple[ContactEnd, PairState]:
    """Surfaces that touch, followed on from until when that is known, and where they crossed then."""
    last = LastCrossing(state.leaves, state.enough, state.instants, np.empty((DEPTH, 2), np.int64))
    ending, last = followed_mesh_contact(one, other, a, b, state.until, end, tolerance, last)
    return ending, PairState(True, state.until, False, last.leaves, last.enough, last.instants)


@inner
def solids_in_piece(
    solids: tuple[Shape, Shape],
    k: int,
    a: Motion,
    b: Motion,
    piece: Piece,
    before: Followed,
    found: Onsets,
    next_contact: Callable[[Shape, Shape, Motion, Motion, float, float, float], Onset],
    end_of_contact: Callable[[Shape, Shape, Motion, Motion, PairState, float, float], tuple[ContactEnd, PairState]],
) -> Followed:
    """From contact to contact, given what finds the next one and what follows it to its end."""
    one, other = solids
    state, count, parted, resumed = before.state, before.onsets, -1.0, 0
    while state.until < piece.length or (state.onset and state.until <= piece.length):
        if state.touches:
            ending, state = end_of_contact(one, other, a, b, state, piece.length, piece.tolerance)
            goes_on = ending.verdict != SearchVerdict.FOUND
            holds = min(ending.holds, max(piece.length, piece.straight))
            state = PairState(goes_on, holds, False, state.leaves, state.enough, state.instants)
            if ending.verdict == SearchVerdict.STALLED:
                return Followed(state, count, False)
            parted = holds
            continue
        if not state.onset:
            onset = next_contact(one, other, a, b, state.until, piece.straight, piece.tolerance)
            begins = onset.verdict == SearchVerdict.FOUND
            if onset.verdict == SearchVerdict.STALLED and onset.time < piece.length:
                nearer, resumed = onset.time > state.until, resumed + 1
                state = PairState(False, onset.time, False, ROOTS, 0.0, 0)
                if nearer and resumed <= MOST_RESUMED:
                    continue
                return Followed(state, count, False)
            until = piece.straight if onset.verdict == SearchVerdict.NEVER else onset.time
            state = PairState(False, until, begins, onset.leaves, 0.0, 0)
            continue
        if state.until == parted:  # what touches again at once has not been seen to part
            return Followed(PairState(True, state.until, False, ROOTS, 0.0, 0), count, False)
        if not (piece.settled and state.until == 0.0):
            count = write_onset(found, count, k, piece.begin + state.until)
        state = PairState(True, state.until, False, state.leaves, 0.0, 0)
    return Followed(state, count, True)


@inner
def write_onset(found: Onsets, count: int, k: int, time: float) -> int:
    """Write an onset, if there is room; returns how many there are."""
    if count < len(found.pairs):
        found.pairs[count], found.times[count] = k, time
    return count + 1


def onsets_of(pairs: int, capacity: int) -> Onsets:
    """Uninitialised, for so many pairs and onsets."""
    return Onsets(np.empty(capacity, np.int64), np.empty(capacity), np.empty(pairs, PAIR_STATE))
