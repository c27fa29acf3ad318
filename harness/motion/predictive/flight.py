"""The loop: take the next event, let it happen, look for the next event of whom it concerned.

Each sphere holds one event, its own earliest; a pair event is held by whichever of the two looked last, with the
other's count of hits. A held event can only be too early (the partner flew elsewhere), never too late: whoever
changes its velocity looks at all its neighbours. So an event that turns out stale costs one more look and nothing
else.
"""

from __future__ import annotations

from math import inf

from harness.kernel import loop, step
from harness.motion.predictive import tournament
from harness.motion.predictive.burst import defer_if_stalled
from harness.motion.predictive.cells import ALL, insert, remove, settle
from harness.motion.predictive.clock import catch_up, rebase, relative
from harness.motion.predictive.hits import begin_to_touch, hit_pair, hit_wall
from harness.motion.predictive.lookahead import look_ahead
from harness.motion.predictive.neighbours import renew, time_to_leave
from harness.motion.predictive.numerics import time_to_plane
from harness.motion.predictive.search import first_onset, first_touch
from harness.motion.predictive.state import (
    BOX_HITS,
    CELLS,
    CROSSING,
    CROSSINGS,
    GRID,
    HITS,
    KIND,
    LABEL,
    LISTS,
    MARK,
    MARK_I,
    MARK_J,
    NONE,
    NOTHING,
    NOW,
    PAIR,
    PAIR_HITS,
    PAIR_TESTS,
    PAIR_TIME,
    PARTNER,
    PARTNER_HITS,
    PLACE,
    POPS,
    PREDICTIONS,
    RADIUS,
    REBASINGS,
    RECORDED,
    RENEWAL,
    RENEWALS,
    STALE,
    TIME,
    VX,
    WALL,
    World,
    X,
)
from harness.motion.predictive.surroundings import gather, next_face

# Why the loop returned.
REACHED, SPENT, FULL, CROWDED, UNTIDY = range(5)


@loop
def populate(world: World, settled: bool) -> None:
    """Put all spheres into their cells: the ones that are marked, or else those where their rows are.

    Play all matches.
    """
    agenda = world.agenda
    for k in range(world.spheres.rows.shape[0]):
        if settled:
            insert(world.cells, world.spheres.marks, k)
        else:
            settle(world.cells, world.spheres.rows, world.spheres.marks, k)
    tournament.rebuild(agenda, world.spheres.marks)


@loop
def fly(world: World, until: float, budget: int) -> int:
    """Let everything happen that is due up to and including `until` (s), or until `budget` hits are answered in all."""
    agenda, counts, clock = world.agenda, world.tally.counts, world.tally.clock
    limit = relative(clock, until)
    while True:
        k = int(agenda.winners[1])
        now = agenda.times[1]
        if not now <= limit or now == inf:
            return REACHED
        if counts[PAIR_HITS] + counts[BOX_HITS] >= budget:
            return SPENT
        if counts[POPS] >= world.rules.span and now > clock[NOW]:
            rebase(world)
            limit = relative(clock, until)
            if world.rules.tidying > 0 and counts[REBASINGS] % world.rules.tidying == 0:
                return UNTIDY
            continue
        if counts[RECORDED] == world.journal.times.size and counts[RECORDED] > 0:
            return FULL
        if defer_if_stalled(world, k, now):
            continue
        clock[NOW] = now
        counts[POPS] += 1
        other, axis, step = happen(world, k, now)
        if axis < 0:
            return CROWDED
        # One place to look from, for the one or two spheres concerned: the search is inlined once.
        for turn in range(2):
            who = k if turn == 0 else other
            if who >= 0:
                look(world, who, now, axis, step)
                tournament.replay(agenda, world.spheres.marks, who)
                if world.rules.crowded:
                    look_ahead(world, who)


@step
def happen(world: World, k: int, now: float) -> tuple[int, int, int]:
    """Carry out sphere k's event.

    Returns the other sphere that must look again (-1: none), and the axis and direction of the new cells to look at
    (ALL: all). An axis of -1 means that a neighbour list is full.
    """
    rows, marks = world.spheres.rows, world.spheres.marks
    kind = int(marks[k, KIND])
    other = -1
    axis = ALL
    step = 0
    if kind == PAIR:
        p = int(marks[k, PARTNER])
        if marks[p, HITS] == marks[k, PARTNER_HITS]:
            if world.rules.response == NONE:
                begin_to_touch(world, k, p, now)
            elif hit_pair(world, k, p, now):
                other = p
        else:
            world.tally.counts[STALE] += 1
    elif kind < CROSSING and kind >= WALL:
        hit_wall(world, k, kind - WALL, now)
    elif kind < RENEWAL and kind >= CROSSING:
        axis = (kind - CROSSING) // 2
        step = 2 * ((kind - CROSSING) % 2) - 1
        remove(world.cells, marks, k)
        marks[k, PLACE + axis] += step
        insert(world.cells, marks, k)
        world.tally.counts[CROSSINGS] += 1
    elif world.rules.method == LISTS:
        catch_up(world, k, now)
        world.tally.counts[RENEWALS] += 1
        if not renew(world.cells, world.lists, rows, marks, k, world.rules.skin, world.scratch.candidates):
            axis = -1
    return other, axis, step


@step
def look(world: World, k: int, now: float, axis: int, step: int) -> None:
    """Find sphere k's next event.

    After a crossing its pair candidate stands, and only the new layer of cells is looked at.
    """
    spheres, counts, clock = world.spheres, world.tally.counts, world.tally.clock
    book, marks = spheres.book, spheres.marks
    candidates = world.scratch.candidates
    if world.rules.method == LISTS:
        count = int(world.lists.members[k, 0])
        candidates = world.lists.members[k, 1:]
    else:
        count = gather(world, k, now, axis, step)
        counts[PAIR_TESTS] -= axis == ALL  # itself among them: zero gap, no hit
    counts[PAIR_TESTS] += count
    if world.rules.response == NONE:
        time, partner = first_onset(
            spheres.rows,
            marks,
            k,
            now,
            world.rules.touching,
            clock[MARK],
            counts[MARK_I],
            counts[MARK_J],
            candidates,
            count,
        )
    else:
        time, partner = first_touch(spheres.rows, marks, k, now, candidates, count, world.scratch.lanes)
    if axis == ALL:
        counts[PREDICTIONS] += 1
        known = inf
    else:
        known = book[k, PAIR_TIME]
    tie = time == known and time < inf and marks[partner, LABEL] < marks[marks[k, PARTNER], LABEL]
    if axis == ALL or time < known or tie:
        book[k, PAIR_TIME] = time
        marks[k, PARTNER] = partner
        marks[k, PARTNER_HITS] = marks[partner, HITS] if partner >= 0 else 0
    schedule(world, k, now)


@step
def schedule(world: World, k: int, now: float) -> None:
    """The earliest of sphere k's pair candidate, walls, cell faces and renewal goes to its leaf."""
    agenda, rows, cells, rules = world.agenda, world.spheres.rows, world.cells, world.rules
    book, marks = world.spheres.book, world.spheres.marks
    begin = rows[k, TIME]
    due = inf
    kind = NOTHING
    grid = marks[k, GRID]
    for axis in range(3):
        x = rows[k, X + axis]
        v = rows[k, VX + axis]
        up = 1 if v > 0.0 else 0
        plane = rules.half_box[axis] - rows[k, RADIUS]
        if rules.method == LISTS and abs(world.lists.anchors[k, axis]) + rules.skin < plane:
            continue  # the list must be renewed before the wall can be reached
        distance = (plane if v > 0.0 else -plane) - x
        target = WALL + 2 * axis + up
        if rules.method == CELLS:
            face = next_face(cells, grid, axis, marks[k, PLACE + axis] + up, up) - x
            if (face < distance) == (v > 0.0):
                distance = face
                target = CROSSING + 2 * axis + up
        time = begin + time_to_plane(distance, v)
        if time < due:
            due = time
            kind = target
    renewal = inf
    if rules.method == LISTS:
        renewal = time_to_leave(world.lists, rows, k, rules.skin)
    elif cells.shapes.shape[0] > 1:
        renewal = cells.renewals[k]
    if renewal < due:
        due = renewal
        kind = RENEWAL
    if book[k, PAIR_TIME] <= due:
        due = book[k, PAIR_TIME]
        kind = PAIR if due < inf else NOTHING
    marks[k, KIND] = kind
    agenda.times[agenda.times.size // 2 + k] = max(due, now)
