"""What the two event loops share: when they stop, what follows from an event, how the next one gets into the queue."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from harness.kernel import step
from harness.motion.predictive import tournament
from harness.motion.predictive.cells import Layer
from harness.motion.predictive.codes import Stop, Task
from harness.motion.predictive.state import World


class FollowUp(NamedTuple):
    """What is to be done after an event.

    task : for the body whose event it was
    other : the other body that must do the same, or `NOBODY`
    layer : the cells that are new to it
    """

    task: Task
    other: int
    layer: Layer


@step
def reason_to_stop(world: World, limit: float, budget: int) -> Stop:
    """Why the next event must not happen, if there is a reason."""
    counts = world.totals.counts[0]
    now = world.queue.times[1]
    if not now <= limit or now == inf:
        return Stop.REACHED
    if counts.pair_hits + counts.box_hits >= budget:
        return Stop.SPENT
    if counts.since_rebasing >= world.rules.events_per_base and now > world.totals.clock[0].now:
        return Stop.REBASE
    if counts.recorded == world.log.size and counts.recorded > 0:
        return Stop.FULL
    return Stop.NOT


@step
def begin(world: World, now: float) -> None:
    """Set the clock to an event that is about to happen."""
    world.totals.clock[0].now = now
    world.totals.counts[0].since_rebasing += 1


@step
def enqueue(world: World, k: int, due: float) -> None:
    """Put the time of body k's scheduled event into the queue, in place of its last one's."""
    world.queue.times[world.queue.times.size // 2 + k] = due
    tournament.update(world.queue, world.spheres.schedule, k)
