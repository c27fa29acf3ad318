"""Local time: spheres are moved only when touched, and times are counted from a base that follows the present.

One ulp of a time is 1e-10 s at 1e6 s and 1e-7 s at 1e9 s; counted from a recent base it stays small against the time
between two hits.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive import tournament
from harness.motion.predictive.state import FRESH, NONE, Record, World


@step
def relative(clock: Record, time: float) -> float:
    """An absolute time (s), counted from the base."""
    return float((time - clock.epoch) - clock.epoch_rest)


@step
def absolute(clock: Record, now: float) -> float:
    """Seconds since the start."""
    return float(clock.epoch + (clock.epoch_rest + now))


@step
def catch_up(world: World, k: int, now: float) -> None:
    """Move sphere k to the present."""
    motion = world.spheres.motions[k]
    flown = now - motion.time
    for axis in range(3):
        motion.position[axis] += motion.velocity[axis] * flown
    motion.time = now


@step
def rebase(world: World) -> None:
    """Make the present the origin of time. Done every so many events, however the run is cut into pieces."""
    if world.rules.response == NONE:
        # Onset times are known again by their bits; those of moved spheres differ, so all look again
        base = world.tally.clock[0].now
        for k in range(world.spheres.motions.size):
            catch_up(world, k, base)
            world.spheres.schedule[k].kind = FRESH
            world.agenda.times[world.agenda.times.size // 2 + k] = base
    shift(world)


@step
def shift(world: World) -> None:
    """Count all times from the present."""
    clock, agenda = world.tally.clock[0], world.agenda
    base = clock.now
    leaf = agenda.times.size // 2
    for k in range(world.spheres.motions.size):
        world.spheres.motions[k].time -= base
        world.spheres.schedule[k].last_hit -= base
        world.spheres.schedule[k].pair_time -= base
        world.spheres.contacts[k] -= base
        world.cells.renewals[k] -= base
        agenda.times[leaf + k] -= base
    whole = clock.epoch + base
    # Exact remainder of the addition (Dekker), as the base is never larger than the new epoch
    clock.epoch_rest += (clock.epoch - whole) + base if clock.epoch >= base else (base - whole) + clock.epoch
    clock.epoch = whole
    world.tally.onset[0].time -= base
    clock.now = 0.0
    world.tally.counts[0].since_rebasing = 0
    world.tally.counts[0].rebasings += 1
    tournament.rebuild(agenda, world.spheres.schedule)
