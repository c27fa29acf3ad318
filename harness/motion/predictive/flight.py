"""The loop: take the next event, let it happen, look for the next event of whom it concerned.

Each sphere holds one event, its own earliest; a pair event is held by whichever of the two looked last, with the
other's count of hits. A held event can only be too early (the partner flew elsewhere), never too late: whoever
changes its velocity looks at all its neighbours. So an event that turns out stale costs one more look and nothing
else.
"""

from __future__ import annotations

from math import inf

import numpy as np

from harness.kernel import loop, step
from harness.motion.predictive import tournament
from harness.motion.predictive.burst import defer_if_stalled, note_hit
from harness.motion.predictive.cells import ALL, gather_around, gather_ball, index, insert, remove, settle
from harness.motion.predictive.clock import catch_up, rebase, relative
from harness.motion.predictive.lookahead import look_ahead
from harness.motion.predictive.neighbours import renew, time_to_leave
from harness.motion.predictive.numerics import approaches, time_to_plane
from harness.motion.predictive.response import bounce, flip
from harness.motion.predictive.search import first_onset, first_touch
from harness.motion.predictive.state import (
    BOX_HITS,
    CELLS,
    CROSSING,
    CROSSINGS,
    ELASTIC,
    FACES,
    GRID,
    GUARDED,
    HITS,
    KIND,
    LABEL,
    LISTS,
    LOST_ENERGY,
    LOST_ENERGY_TIME,
    MARK,
    MARK_I,
    MARK_J,
    MASS,
    NONE,
    NOTHING,
    NOW,
    PAIR,
    PAIR_HITS,
    PAIR_TESTS,
    PAIR_TIME,
    PAIR_VIRIAL,
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
    WALL_VIRIAL,
    World,
    X,
)
from harness.motion.predictive.tally import absolute, add

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
def hit_pair(world: World, k: int, p: int, now: float) -> bool:
    """Answer a pair if it still approaches. The labels order the two, so that it does not matter who held the event."""
    spheres, rules, tally = world.spheres, world.rules, world.tally
    rows = spheres.rows
    catch_up(world, k, now)
    catch_up(world, p, now)
    if not approaches(
        rows[p, X] - rows[k, X],
        rows[p, X + 1] - rows[k, X + 1],
        rows[p, X + 2] - rows[k, X + 2],
        rows[p, VX] - rows[k, VX],
        rows[p, VX + 1] - rows[k, VX + 1],
        rows[p, VX + 2] - rows[k, VX + 2],
    ):
        return False
    swap = spheres.marks[p, LABEL] < spheres.marks[k, LABEL]
    i = p if swap else k
    j = k if swap else p
    if rules.response == ELASTIC:
        restitution = rules.restitution
        if restitution < 1.0:
            # TC model: a contact so soon after another belongs to the same lasting contact, and loses nothing more
            if now - max(spheres.contacts[i], spheres.contacts[j]) < rules.contact_time:
                restitution = 1.0
                tally.counts[GUARDED] += 1
            spheres.contacts[i] = now
            spheres.contacts[j] = now
        virial, lost = bounce(rows, spheres.book, i, j, restitution)
        if lost > 0.0:
            add(tally, LOST_ENERGY, lost)
            add(tally, LOST_ENERGY_TIME, lost * absolute(tally.clock, now))
    else:
        virial = flip(rows, spheres.book, i, j)
    add(tally, PAIR_VIRIAL, virial)
    note_hit(world, i, now, rules.blink)
    note_hit(world, j, now, rules.blink)
    tally.counts[PAIR_HITS] += 1
    record(world, now, 0, spheres.marks[i, LABEL], spheres.marks[j, LABEL], -1)
    return True


@step
def begin_to_touch(world: World, k: int, p: int, now: float) -> None:
    """Nothing answers: note the onset, once, although both spheres may hold it."""
    counts, clock = world.tally.counts, world.tally.clock
    i = min(world.spheres.marks[k, LABEL], world.spheres.marks[p, LABEL])
    j = max(world.spheres.marks[k, LABEL], world.spheres.marks[p, LABEL])
    if now != clock[MARK] or i != counts[MARK_I] or j != counts[MARK_J]:
        clock[MARK] = now
        counts[MARK_I] = i
        counts[MARK_J] = j
        counts[PAIR_HITS] += 1
        record(world, now, 0, i, j, -1)


@step
def hit_wall(world: World, k: int, face: int, now: float) -> None:
    """Mirror sphere k's velocity at a face (x-, x+, y-, y+, z-, z+)."""
    rows, tally = world.spheres.rows, world.tally
    axis = face // 2
    plane = world.rules.half_box[axis] - rows[k, RADIUS]
    inside = abs(rows[k, X + axis]) <= plane
    catch_up(world, k, now)
    if inside:
        # Exactly on the plane: what time rounds away at any speed cannot add up to an escape
        rows[k, X + axis] = plane if face % 2 == 1 else -plane
    impulse = 2.0 * world.spheres.book[k, MASS] * abs(rows[k, VX + axis])
    rows[k, VX + axis] = -rows[k, VX + axis]
    add(tally, FACES + face, impulse)
    add(tally, WALL_VIRIAL, impulse * rows[k, X + axis] * (1.0 if face % 2 == 1 else -1.0))
    note_hit(world, k, now, 0.0)
    tally.counts[BOX_HITS] += 1
    record(world, now, 1, world.spheres.marks[k, LABEL], -1, face)


@step
def record(world: World, now: float, kind: int, i: int, j: int, wall: int) -> None:
    """Write an event down, if somebody reads it."""
    journal, counts = world.journal, world.tally.counts
    if journal.times.size > 0:
        place = counts[RECORDED]
        journal.times[place] = absolute(world.tally.clock, now)
        journal.kinds[place] = kind
        journal.first[place] = i
        journal.second[place] = j
        journal.walls[place] = wall
        counts[RECORDED] += 1


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
def gather(world: World, k: int, now: float, axis: int, step: int) -> int:
    """Candidates from the cells: one's own grid, coarser grids around, finer grids within reach."""
    cells, rows, found = world.cells, world.spheres.rows, world.scratch.candidates
    marks = world.spheres.marks
    own = int(marks[k, GRID])
    count = gather_around(cells, own, marks[k, PLACE], marks[k, PLACE + 1], marks[k, PLACE + 2], axis, step, found, 0)
    if cells.shapes.shape[0] > 1:
        flown = now - rows[k, TIME]
        x = rows[k, X] + rows[k, VX] * flown
        y = rows[k, X + 1] + rows[k, VX + 1] * flown
        z = rows[k, X + 2] + rows[k, VX + 2] * flown
        for grid in range(own):
            ix, iy, iz = index(cells, grid, 0, x), index(cells, grid, 1, y), index(cells, grid, 2, z)
            count = gather_around(cells, grid, ix, iy, iz, ALL, 0, found, count)
        if axis == ALL and own < cells.shapes.shape[0] - 1:
            margin = cells.frames[own, 7]
            for grid in range(own + 1, cells.shapes.shape[0]):
                reach = rows[k, RADIUS] + cells.frames[grid, 6] + margin
                count = gather_ball(cells, grid, x, y, z, reach, found, count)
            speed = np.sqrt(rows[k, VX] ** 2 + rows[k, VX + 1] ** 2 + rows[k, VX + 2] ** 2)
            cells.renewals[k] = now + 0.999 * margin / speed if speed > 0.0 else inf
    return count


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
            place = marks[k, PLACE + axis] + up
            if 0 < place < cells.shapes[grid, axis]:
                face = cells.frames[grid, axis] + place * cells.frames[grid, 3 + axis] - x
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
