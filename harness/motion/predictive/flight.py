"""The loop: take the next event, let it happen, look for the next event of whom it concerned.

Each sphere holds one event, its own earliest; a pair event is held by whichever of the two looked last, with the
other's count of hits. A held event can only be too early (the partner flew elsewhere), never too late: whoever
changes its velocity looks at all its neighbours. So an event that turns out stale costs one more look and nothing
else.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from harness.kernel import loop, step
from harness.motion.predictive import tournament
from harness.motion.predictive.burst import defer_if_stalled
from harness.motion.predictive.cells import ALL, Layer, insert, next_face, remove, settle
from harness.motion.predictive.clock import catch_up, rebase, relative
from harness.motion.predictive.hits import begin_to_touch, hit_pair, hit_wall
from harness.motion.predictive.lookahead import look_ahead
from harness.motion.predictive.neighbours import renew, time_to_leave
from harness.motion.predictive.numerics import time_to_plane
from harness.motion.predictive.search import first_onset, first_touch
from harness.motion.predictive.state import (
    CELLS,
    CROSSING,
    LISTS,
    NONE,
    NOTHING,
    PAIR,
    RENEWAL,
    WALL,
    World,
)
from harness.motion.predictive.surroundings import gather

# Why the loop returned.
REACHED, SPENT, FULL, CROWDED, UNTIDY = range(5)

NOBODY = -1


class Aftermath(NamedTuple):
    """What is to be done after an event.

    other : the other sphere that must look again, or `NOBODY`
    layer : the cells that are new to those who look
    room : False if a neighbour list is full
    """

    other: int
    layer: Layer
    room: bool


@loop
def populate(world: World, settled: bool) -> None:
    """Put all spheres into their cells: the ones of their records, or else those where their positions are.

    Play all matches.
    """
    for k in range(world.spheres.motions.size):
        if settled:
            insert(world.cells, world.spheres.schedule, k)
        else:
            settle(world.cells, world.spheres, k)
    tournament.rebuild(world.agenda, world.spheres.schedule)


@loop
def fly(world: World, until: float, budget: int) -> int:
    """Let everything happen that is due up to and including `until` (s), or until `budget` hits are answered in all."""
    agenda, counts, clock = world.agenda, world.tally.counts[0], world.tally.clock[0]
    limit = relative(clock, until)
    while True:
        k = int(agenda.winners[1])
        now = agenda.times[1]
        if not now <= limit or now == inf:
            return REACHED
        if counts.pair_hits + counts.box_hits >= budget:
            return SPENT
        if counts.since_rebasing >= world.rules.span and now > clock.now:
            rebase(world)
            limit = relative(clock, until)
            if world.rules.tidying > 0 and counts.rebasings % world.rules.tidying == 0:
                return UNTIDY
            continue
        if counts.recorded == world.journal.size and counts.recorded > 0:
            return FULL
        if defer_if_stalled(world, k, now):
            continue
        clock.now = now
        counts.since_rebasing += 1
        after = happen(world, k, now)
        if not after.room:
            return CROWDED
        # One place to look from, for the one or two spheres concerned: the search is inlined once.
        for turn in range(2):
            who = k if turn == 0 else after.other
            if who >= 0:
                look(world, who, now, after.layer)
                tournament.replay(agenda, world.spheres.schedule, who)
                if world.rules.crowded:
                    look_ahead(world, who)


@step
def happen(world: World, k: int, now: float) -> Aftermath:
    """Carry out sphere k's event."""
    schedule, counts = world.spheres.schedule, world.tally.counts[0]
    kind = int(schedule[k].kind)
    other = NOBODY
    axis = ALL
    step = 0
    room = True
    if kind == PAIR:
        p = int(schedule[k].partner)
        if schedule[p].hits == schedule[k].partner_hits:
            if world.rules.response == NONE:
                begin_to_touch(world, k, p, now)
            elif hit_pair(world, k, p, now):
                other = p
        else:
            counts.stale_events += 1
    elif kind < CROSSING and kind >= WALL:
        hit_wall(world, k, kind - WALL, now)
    elif kind < RENEWAL and kind >= CROSSING:
        axis = (kind - CROSSING) // 2
        step = 2 * ((kind - CROSSING) % 2) - 1
        remove(world.cells, schedule, k)
        schedule[k].cell[axis] += step
        insert(world.cells, schedule, k)
        counts.cell_crossings += 1
    elif world.rules.method == LISTS:
        catch_up(world, k, now)
        counts.list_renewals += 1
        room = renew(world, k)
    return Aftermath(other, Layer(axis, step), room)


@step
def look(world: World, k: int, now: float, layer: Layer) -> None:
    """Find sphere k's next event.

    After a crossing its pair candidate stands, and only the new layer of cells is looked at.
    """
    schedule, counts = world.spheres.schedule, world.tally.counts[0]
    own = schedule[k]
    candidates = world.scratch.found
    if world.rules.method == LISTS:
        count = int(world.lists.members[k].count)
        candidates = world.lists.members[k].who[:]
    else:
        count = gather(world, k, now, layer)
        counts.pair_tests -= layer.axis == ALL  # itself among them: zero gap, no hit
    counts.pair_tests += count
    if world.rules.response == NONE:
        time, partner = first_onset(world, k, now, candidates, count)
    else:
        time, partner = first_touch(world, k, now, candidates, count)
    if layer.axis == ALL:
        counts.predictions += 1
        known = inf
    else:
        known = own.pair_time
    tie = time == known and time < inf and schedule[partner].label < schedule[own.partner].label
    if layer.axis == ALL or time < known or tie:
        own.pair_time = time
        own.partner = partner
        own.partner_hits = schedule[partner].hits if partner >= 0 else 0
    schedule_next(world, k, now)


@step
def schedule_next(world: World, k: int, now: float) -> None:
    """The earliest of sphere k's pair candidate, walls, cell faces and renewal goes to its leaf."""
    agenda, cells, rules = world.agenda, world.cells, world.rules
    motion, own = world.spheres.motions[k], world.spheres.schedule[k]
    begin = motion.time
    due = inf
    kind = NOTHING
    grid = cells.grids[own.size_class]
    for axis in range(3):
        x = motion.position[axis]
        v = motion.velocity[axis]
        up = 1 if v > 0.0 else 0
        plane = rules.half_box[axis] - motion.radius
        if rules.method == LISTS and abs(world.lists.anchors[k, axis]) + rules.skin < plane:
            continue  # the list must be renewed before the wall can be reached
        distance = (plane if v > 0.0 else -plane) - x
        target = WALL + 2 * axis + up
        if rules.method == CELLS:
            face = next_face(grid, axis, own.cell[axis] + up, up) - x
            if (face < distance) == (v > 0.0):
                distance = face
                target = CROSSING + 2 * axis + up
        time = begin + time_to_plane(distance, v)
        if time < due:
            due = time
            kind = target
    renewal = inf
    if rules.method == LISTS:
        renewal = time_to_leave(world.lists, world.spheres.motions, k, rules.skin)
    elif cells.grids.size > 1:
        renewal = cells.renewals[k]
    if renewal < due:
        due = renewal
        kind = RENEWAL
    if own.pair_time <= due:
        due = own.pair_time
        kind = PAIR if due < inf else NOTHING
    own.kind = kind
    agenda.times[agenda.times.size // 2 + k] = max(due, now)
