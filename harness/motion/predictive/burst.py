"""Collision bursts: hits of one sphere that follow each other within the burst window.

Elastic bursts are finite, however long (a light ball between a heavy one and a wall). Mirrored velocities of a sphere
that overlaps several others, or a ball larger than its box, can go on forever, some of them in steps of 1e-17 s. So a
sphere whose burst has reached the limit waits for a cooldown before each further hit, and each such wait is counted.

Such a motion is ill-posed, and must not cost without bound: the cooldown doubles after every `WAITS` waits, up to a
sixteenth of the time in which a mean sphere flies its radius.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.codes import Event
from harness.motion.predictive.events import enqueue
from harness.motion.predictive.state import World

# Waits of a run from one doubling of the cooldown to the next, and the most doublings.
WAITS, DOUBLINGS = 1 << 14, 6


@step
def note_hit(world: World, k: int, now: float, window: float) -> None:
    """Count a change of sphere k's velocity, which makes events for the old one stale, and its part in a burst.

    The hit belongs to the burst of the last one if it comes within the window (s).
    """
    own, rules = world.spheres.schedule[k], world.rules
    own.hits += 1
    own.changed = world.totals.counts[0].since_rebasing
    since = now - own.last_hit
    stalled = own.burst_hits >= rules.burst_limit and since <= 2.0 * present_cooldown(world)
    if since <= window:
        own.burst_hits += 1
    elif not stalled:
        own.burst_hits = 0
    own.last_hit = now


@step
def defer_if_stalled(world: World, k: int, now: float) -> bool:
    """Put off the hit that sphere k's event is if it, or its partner, must wait for the end of its cooldown."""
    own = world.spheres.schedule[k]
    wait = 0.0
    if own.kind == Event.PAIR:
        wait = max(cooldown(world, k, now), cooldown(world, own.partner, now))
    elif own.kind == Event.WALL:
        wait = cooldown(world, k, now)
    if wait <= 0.0:
        return False
    if own.kind == Event.PAIR:
        own.pair_time = now + wait
    enqueue(world, k, now + wait)
    world.totals.counts[0].stalled_events += 1
    return True


@step
def cooldown(world: World, k: int, now: float) -> float:
    """For how long, s, sphere k must wait before its next hit."""
    own = world.spheres.schedule[k]
    if own.burst_hits < world.rules.burst_limit or now - own.last_hit > world.rules.burst_window:
        return 0.0
    return present_cooldown(world)


@step
def present_cooldown(world: World) -> float:
    """For how long, s, a sphere whose burst has reached the limit waits, given how often all have waited."""
    return float(world.rules.cooldown * (1 << min(world.totals.counts[0].stalled_events // WAITS, DOUBLINGS)))
