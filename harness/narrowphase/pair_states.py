"""What is known of a pair of bodies from one frame to the next, while both go on as they did.

A pair that was searched for its next contact need not be searched again before that, and one whose contact certainly
lasts into the next frame is followed from there on.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from harness.kernel import strict_step
from harness.narrowphase.tree_pairs import ROOTS, NodePair

PAIR_STATE = np.dtype(
    [
        ("key", "i8"),
        ("touches", "?"),
        ("until", "f8"),
        ("onset", "?"),
        ("leaf_a", "i8"),
        ("leaf_b", "i8"),
        ("enough", "f8"),
        ("instants", "i8"),
    ],
    align=True,
)
"""A `PairState`, with i << 32 | j of the pair."""

PairStates: TypeAlias = NDArray[np.void]
"""(k,) of PAIR_STATE, ascending by key."""


class PairState(NamedTuple):
    """What is known of a pair at the beginning of a straight piece of its way.

    Attributes
    ----------
    touches : whether it touches
    until : s, how long that is known to last
    onset : whether it is known to begin to touch then
    leaves, enough, instants : of two surfaces that touch, as of a `LastCrossing`
    """

    touches: bool
    until: float
    onset: bool
    leaves: NodePair
    enough: float
    instants: int


NOTHING_KNOWN = PairState(False, 0.0, False, ROOTS, 0.0, 0)


@strict_step
def later(state: PairState, time: float) -> PairState:
    """The state after a time (s) for which it lasts."""
    until = max(state.until - time, 0.0)
    return PairState(state.touches, until, state.onset, state.leaves, state.enough, state.instants)


@strict_step
def at_turn(state: PairState) -> PairState:
    """The state where the motion of either body changes: what was known of what comes is known no longer."""
    return PairState(state.touches, 0.0, False, state.leaves, state.enough, state.instants)


@strict_step
def state_of(states: PairStates, place: int, key: int) -> PairState:
    """The state at a place, if it is that of a key."""
    state = NOTHING_KNOWN
    if place < len(states) and states[place].key == key:
        row = states[place]
        leaves = NodePair(row.leaf_a, row.leaf_b)
        state = PairState(row.touches, row.until, row.onset, leaves, row.enough, row.instants)
    return state


@strict_step
def keep(states: PairStates, k: int, key: int, state: PairState) -> None:
    """Write a state."""
    row = states[k]
    row.key, row.touches, row.until, row.onset = key, state.touches, state.until, state.onset
    row.leaf_a, row.leaf_b = state.leaves
    row.enough, row.instants = state.enough, state.instants
