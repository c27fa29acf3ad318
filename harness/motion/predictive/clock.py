"""Local time: spheres are moved only when touched, and times are counted from a base that follows the present.

One ulp of a time is 1e-10 s at 1e6 s and 1e-7 s at 1e9 s; counted from a recent base it stays small against the time
between two hits.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive import tournament
from harness.motion.predictive.codes import Event, ResponseCode
from harness.motion.predictive.state import Record, Records, World


@step
def relative(clock: Record, time: float) -> float:
    """An absolute time (s), counted from the base."""
    return float((time - clock.epoch) - clock.epoch_rest)


@step
def absolute(clock: Record, now: float) -> float:
    """Seconds since the start, of a time counted from the base."""
    return float(clock.epoch + (clock.epoch_rest + now))


@step
def advance(world: World, k: int, now: float) -> None:
    """Move sphere k to the present."""
    motion = world.spheres.motions[k]
    flown = now - motion.time
    for axis in range(3):
        motion.position[axis] += motion.velocity[axis] * flown
    motion.time = now


@step
def rebase(world: World) -> None:
    """Make the present the base of time. Done every so many events, however the run is cut into pieces."""
    if world.rules.response == ResponseCode.NONE:
        # Onset times are known again by their bits; those of moved spheres differ, so all predict anew
        now = world.totals.clock[0].now
        for k in range(world.spheres.motions.size):
            advance(world, k, now)
            world.spheres.schedule[k].kind = Event.UNSCHEDULED
            world.queue.times[world.queue.times.size // 2 + k] = now
    shift_times(world)


@step
def shift_times(world: World) -> None:
    """Count all times from the present."""
    clock, queue = world.totals.clock[0], world.queue
    base = clock.now
    leaf = queue.times.size // 2
    for k in range(world.spheres.motions.size):
        world.spheres.motions[k].time -= base
        world.spheres.schedule[k].last_hit -= base
        world.spheres.schedule[k].pair_time -= base
        world.spheres.contacts[k].last -= base
        world.cells.renewals[k] -= base
        queue.times[leaf + k] -= base
    whole = clock.epoch + base
    # Exact remainder of the addition (Dekker), as the base is never larger than the new epoch
    clock.epoch_rest += (clock.epoch - whole) + base if clock.epoch >= base else (base - whole) + clock.epoch
    clock.epoch = whole
    clock.now = 0.0
    world.totals.onset[0].time -= base
    restart_count(world.spheres.schedule)
    world.totals.counts[0].since_rebasing = 0
    world.totals.counts[0].rebasings += 1
    tournament.rebuild(queue, world.spheres.schedule)


@step
def restart_count(schedule: Records) -> None:
    """Count events from the present: what was predicted before is from event 0, or stale."""
    for k in range(schedule.size):
        own = schedule[k]
        if own.partner >= 0:
            own.predicted = 0 if schedule[own.partner].changed <= own.predicted else -1
    for k in range(schedule.size):
        schedule[k].changed = 0
