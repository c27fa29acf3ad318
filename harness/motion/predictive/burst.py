"""Many hits in no time: told from endless ones, which are made to wait.

Elastic hits in no time are finite in number, however many (a light ball between a heavy one and a wall). Mirrored
velocities of a sphere that overlaps several others, or a ball larger than its box, can go on forever, some of them in
steps of 1e-17 s. A sphere that has had its share waits a `pause` for its next hit, and each such wait is counted.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive import tournament
from harness.motion.predictive.state import (
    BURST,
    CROSSING,
    HITS,
    KIND,
    PAIR,
    PAIR_TIME,
    PARTNER,
    STALLED,
    TOUCHED,
    WALL,
    World,
)


@step
def note_hit(world: World, k: int, now: float, blink: float) -> None:
    """Sphere k's velocity changed: events made for the old one are stale; it may be one more hit in no time."""
    spheres, rules = world.spheres, world.rules
    spheres.marks[k, HITS] += 1
    since = now - spheres.book[k, TOUCHED]  # "no time" is what is not longer than a blink
    stalled = spheres.marks[k, BURST] >= rules.burst and since <= 2.0 * rules.pause
    if since <= blink:
        spheres.marks[k, BURST] += 1
    elif not stalled:
        spheres.marks[k, BURST] = 0
    spheres.book[k, TOUCHED] = now


@step
def defer_if_stalled(world: World, k: int, now: float) -> bool:
    """Put off the hit that sphere k holds if it, or its partner, has had too many in no time."""
    kind = int(world.spheres.marks[k, KIND])
    wait = 0.0
    if kind == PAIR:
        wait = max(patience(world, k, now), patience(world, int(world.spheres.marks[k, PARTNER]), now))
    elif kind >= WALL and kind < CROSSING:
        wait = patience(world, k, now)
    if wait <= 0.0:
        return False
    agenda = world.agenda
    if kind == PAIR:
        world.spheres.book[k, PAIR_TIME] = now + wait
    agenda.times[agenda.times.size // 2 + k] = now + wait
    tournament.replay(agenda, world.spheres.marks, k)
    world.tally.counts[STALLED] += 1
    return True


@step
def patience(world: World, k: int, now: float) -> float:
    """How long a sphere must wait for its next hit."""
    spheres = world.spheres
    if spheres.marks[k, BURST] < world.rules.burst or now - spheres.book[k, TOUCHED] > world.rules.blink:
        return 0.0
    return world.rules.pause
