"""Many hits in no time: told from endless ones, which are made to wait.

Elastic hits in no time are finite in number, however many (a light ball between a heavy one and a wall). Mirrored
velocities of a sphere that overlaps several others, or a ball larger than its box, can go on forever, some of them in
steps of 1e-17 s. A sphere that has had its share waits a `pause` for its next hit, and each such wait is counted.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive import tournament
from harness.motion.predictive.state import CROSSING, PAIR, WALL, World


@step
def note_hit(world: World, k: int, now: float, blink: float) -> None:
    """Sphere k's velocity changed: events made for the old one are stale; it may be one more hit in no time."""
    own, rules = world.spheres.schedule[k], world.rules
    own.hits += 1
    since = now - own.last_hit  # "no time" is what is not longer than a blink
    stalled = own.burst >= rules.burst and since <= 2.0 * rules.pause
    if since <= blink:
        own.burst += 1
    elif not stalled:
        own.burst = 0
    own.last_hit = now


@step
def defer_if_stalled(world: World, k: int, now: float) -> bool:
    """Put off the hit that sphere k holds if it, or its partner, has had too many in no time."""
    own = world.spheres.schedule[k]
    wait = 0.0
    if own.kind == PAIR:
        wait = max(patience(world, k, now), patience(world, own.partner, now))
    elif own.kind >= WALL and own.kind < CROSSING:
        wait = patience(world, k, now)
    if wait <= 0.0:
        return False
    agenda = world.agenda
    if own.kind == PAIR:
        own.pair_time = now + wait
    agenda.times[agenda.times.size // 2 + k] = now + wait
    tournament.replay(agenda, world.spheres.schedule, k)
    world.tally.counts[0].stalled_events += 1
    return True


@step
def patience(world: World, k: int, now: float) -> float:
    """How long a sphere must wait for its next hit."""
    own = world.spheres.schedule[k]
    if own.burst < world.rules.burst or now - own.last_hit > world.rules.blink:
        return 0.0
    return world.rules.pause
