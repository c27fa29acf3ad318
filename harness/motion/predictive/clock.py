"""Local time: spheres are moved only when touched, and times are counted from a base that follows the present.

One ulp of a time is 1e-10 s at 1e6 s and 1e-7 s at 1e9 s; counted from a recent base it stays small against the time
between two hits.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive import tournament
from harness.motion.predictive.state import (
    EPOCH,
    EPOCH_REST,
    FRESH,
    KIND,
    MARK,
    NONE,
    NOW,
    PAIR_TIME,
    POPS,
    REBASINGS,
    TIME,
    TOUCHED,
    VX,
    Floats,
    World,
    X,
)


@step
def relative(clock: Floats, time: float) -> float:
    """An absolute time (s), counted from the base."""
    return float((time - clock[EPOCH]) - clock[EPOCH_REST])


@step
def catch_up(world: World, k: int, now: float) -> None:
    """Move sphere k to the present."""
    rows = world.spheres.rows
    flown = now - rows[k, TIME]
    for axis in range(3):
        rows[k, X + axis] += rows[k, VX + axis] * flown
    rows[k, TIME] = now


@step
def rebase(world: World) -> None:
    """Make the present the origin of time. Done every so many events, however the run is cut into pieces."""
    if world.rules.response == NONE:
        # Onset times are known again by their bits; those of moved rows differ, so all look again
        base = world.tally.clock[NOW]
        for k in range(world.spheres.rows.shape[0]):
            catch_up(world, k, base)
            world.spheres.marks[k, KIND] = FRESH
            world.agenda.times[world.agenda.times.size // 2 + k] = base
    shift(world)


@step
def shift(world: World) -> None:
    """Count all times from the present."""
    clock, agenda = world.tally.clock, world.agenda
    base = clock[NOW]
    leaf = agenda.times.size // 2
    for k in range(world.spheres.rows.shape[0]):
        world.spheres.rows[k, TIME] -= base
        world.spheres.book[k, TOUCHED] -= base
        world.spheres.book[k, PAIR_TIME] -= base
        world.spheres.contacts[k] -= base
        world.cells.renewals[k] -= base
        agenda.times[leaf + k] -= base
    whole = clock[EPOCH] + base
    # Exact remainder of the addition (Dekker), as the base is never larger than the new epoch
    clock[EPOCH_REST] += (clock[EPOCH] - whole) + base if clock[EPOCH] >= base else (base - whole) + clock[EPOCH]
    clock[EPOCH] = whole
    clock[MARK] -= base
    clock[NOW] = 0.0
    world.tally.counts[POPS] = 0
    world.tally.counts[REBASINGS] += 1
    tournament.rebuild(agenda, world.spheres.marks)
