"""The loop for bodies of any shape: bounding spheres open windows, and what happens inside is searched when due.

It is the loop of spheres with one kind of event more, the search. A body holds all its windows, not the earliest one
alone, as a search that has been paid for should not be asked for again. The loop itself is a strict kernel, since those
of the narrow phase, which it calls, are compiled in its image: they need memory of their own, and exact rounding.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from harness.kernel import kernel, step
from harness.motion.predictive import tournament, windows
from harness.motion.predictive.burst import patience
from harness.motion.predictive.cells import ALL, insert, remove
from harness.motion.predictive.clock import catch_up, relative
from harness.motion.predictive.clock import shift as shift_spheres
from harness.motion.predictive.flight import CROWDED, FULL, REACHED, SPENT
from harness.motion.predictive.hits import begin_to_touch, hit_pair, reach_plane, turn_back
from harness.motion.predictive.narrow import search_pair, search_wall
from harness.motion.predictive.numerics import time_to_plane
from harness.motion.predictive.solids import Solids, turn_to_base
from harness.motion.predictive.state import (
    BOX_HITS,
    CROSSING,
    CROSSINGS,
    FRESH,
    GRID,
    HITS,
    KIND,
    NONE,
    NOTHING,
    NOW,
    PAIR,
    PAIR_HITS,
    PAIR_TESTS,
    PARTNER,
    PLACE,
    POPS,
    PREDICTIONS,
    RADIUS,
    RECORDED,
    RENEWAL,
    SEARCH,
    STALE,
    STALLED,
    TIME,
    VX,
    WALL,
    World,
    X,
)
from harness.motion.predictive.surroundings import gather, next_face
from harness.motion.predictive.windows import (
    APART,
    COUNT,
    DUE,
    NEAR,
    NOBODY,
    OTHER,
    OTHER_HITS,
    PHASE,
    TOUCHING,
    UNSURE,
    Windows,
    find,
    holds,
    next_due,
)
from harness.narrowphase.spheres import passage, time_to_touch

# What a body must do after an event: look at all around it anew, look only for whom it does not know yet, or neither.
ANEW, MORE, SAME = range(3)


class SolidWorld(NamedTuple):
    """The spheres around the bodies, their shape, and their windows."""

    world: World
    body: Solids
    windows: Windows


@kernel
def fly_solids(solid: SolidWorld, until: float, budget: int) -> int:
    """Let everything happen that is due up to and including `until` (s), or until `budget` hits are answered in all."""
    world = solid.world
    agenda, counts, clock = world.agenda, world.tally.counts, world.tally.clock
    limit = relative(clock, until)
    while True:
        k = int(agenda.winners[1])
        now = agenda.times[1]
        if not now <= limit or now == inf:
            return REACHED
        if counts[PAIR_HITS] + counts[BOX_HITS] >= budget:
            return SPENT
        if solid.windows.free[COUNT] < 2 * world.spheres.rows.shape[0]:
            return CROWDED
        if counts[POPS] >= world.rules.span and now > clock[NOW]:
            windows.shift(solid.windows, clock[NOW])
            shift_spheres(world)
            turn_to_base(solid.body, clock)
            limit = relative(clock, until)
            continue
        if counts[RECORDED] == world.journal.times.size and counts[RECORDED] > 0:
            return FULL
        clock[NOW] = now
        counts[POPS] += 1
        task, other, axis, step = SAME, NOBODY, ALL, 0
        if world.spheres.marks[k, KIND] == SEARCH:
            search(solid, k, now)
        else:
            task, other, axis, step = happen(solid, k, now)
        for turn in range(2):
            who = k if turn == 0 else other
            if who >= 0:
                if task != SAME:
                    look(solid, who, now, task == ANEW, axis, step)
                schedule(solid, who, now)
                tournament.replay(agenda, world.spheres.marks, who)


@kernel
def search(solid: SolidWorld, k: int, now: float) -> None:
    """Carry out the search that body k's event is."""
    held = int(solid.windows.held[k])
    if held < 0:
        search_wall(solid.world, solid.body, solid.windows, k, -1 - held, now)
    elif holds(solid.windows, solid.world.spheres.marks, held):
        search_pair(solid.world, solid.body, solid.windows, k, held, now)
    else:
        windows.remove(solid.windows, k, held)
        solid.world.tally.counts[STALE] += 1


@step
def happen(solid: SolidWorld, k: int, now: float) -> tuple[int, int, int, int]:
    """Carry out body k's event, other than a search.

    Returns what it must do then, who else must do so (-1: nobody), and the axis and direction of the new cells to look
    at (ALL: all).
    """
    world = solid.world
    marks = world.spheres.marks
    kind = int(marks[k, KIND])
    if kind == PAIR:
        held = int(solid.windows.held[k])
        if holds(solid.windows, marks, held):
            return meet(solid, k, held, now)
        windows.remove(solid.windows, k, held)
        world.tally.counts[STALE] += 1
        return SAME, NOBODY, ALL, 0
    if kind >= WALL and kind < CROSSING:
        return meet_wall(solid, k, kind - WALL, now), NOBODY, ALL, 0
    if kind >= CROSSING and kind < RENEWAL:
        axis = (kind - CROSSING) // 2
        step = 2 * ((kind - CROSSING) % 2) - 1
        remove(world.cells, marks, k)
        marks[k, PLACE + axis] += step
        insert(world.cells, marks, k)
        world.tally.counts[CROSSINGS] += 1
        return MORE, NOBODY, axis, step
    return (ANEW if kind == FRESH else MORE), NOBODY, ALL, 0


@step
def meet(solid: SolidWorld, k: int, w: int, now: float) -> tuple[int, int, int, int]:
    """Body k and the other of its window w touch."""
    world = solid.world
    p = int(solid.windows.marks[w, OTHER])
    wait = max(patience(world, k, now), patience(world, p, now))
    if wait > 0.0:
        solid.windows.times[w] = now + wait
        world.tally.counts[STALLED] += 1
        return SAME, NOBODY, ALL, 0
    if world.rules.response == NONE:
        begin_to_touch(world, k, p, now)
        solid.windows.marks[w, PHASE] = TOUCHING
    elif hit_pair(world, k, p, now):
        return ANEW, p, ALL, 0
    else:
        windows.remove(solid.windows, k, w)
    return SAME, NOBODY, ALL, 0


@step
def meet_wall(solid: SolidWorld, k: int, face: int, now: float) -> int:
    """Body k touches a wall, or its sphere does where only that is reflected."""
    world = solid.world
    axis = face // 2
    wait = patience(world, k, now)
    if wait > 0.0:
        solid.windows.wall_times[k, axis] = now + wait
        world.tally.counts[STALLED] += 1
        return SAME
    if world.rules.response == NONE:
        reach_plane(world, k, face, world.rules.half_box[axis] - 0.5 * solid.body.sizes[k], now)
    else:
        catch_up(world, k, now)
    turn_back(world, k, face, now)
    return ANEW


@step
def look(solid: SolidWorld, k: int, now: float, anew: bool, axis: int, step: int) -> None:
    """Open body k's windows: on everybody around it, or on those it does not know yet."""
    world = solid.world
    known = int(solid.windows.heads[k])
    if anew:
        solid.windows.heads[k] = NOBODY
        look_at_walls(solid, k, now)
        world.tally.counts[PREDICTIONS] += 1
    count = gather(world, k, now, axis, step)
    world.tally.counts[PAIR_TESTS] += count - (axis == ALL)
    for m in range(count):
        p = int(world.scratch.candidates[m])
        if p != k:
            open_window(solid, k, p, now, anew, known)
    if anew:
        windows.close_all(solid.windows, known)


@step
def open_window(solid: SolidWorld, k: int, p: int, now: float, anew: bool, known: int) -> None:
    """Open body k's window on body p, if their spheres meet and neither holds one on the other that stands."""
    world, open_ = solid.world, solid.windows
    rows, marks = world.spheres.rows, world.spheres.marks
    flown, flown_p = now - rows[k, TIME], now - rows[p, TIME]
    x = (rows[p, X] + rows[p, VX] * flown_p) - (rows[k, X] + rows[k, VX] * flown)
    y = (rows[p, X + 1] + rows[p, VX + 1] * flown_p) - (rows[k, X + 1] + rows[k, VX + 1] * flown)
    z = (rows[p, X + 2] + rows[p, VX + 2] * flown_p) - (rows[k, X + 2] + rows[k, VX + 2] * flown)
    u, v, w = rows[p, VX] - rows[k, VX], rows[p, VX + 1] - rows[k, VX + 1], rows[p, VX + 2] - rows[k, VX + 2]
    reach = rows[k, RADIUS] + rows[p, RADIUS]
    inside = x * x + y * y + z * z <= reach * reach
    wait = time_to_touch((x, y, z), (u, v, w), reach)
    if world.rules.response == NONE and inside:
        wait = 0.0
    if wait == inf:
        return
    theirs = find(open_, open_.heads[p], k)
    if holds(open_, marks, theirs) or (not anew and holds(open_, marks, find(open_, known, p))):
        return
    before = find(open_, known, p) if anew else NOBODY
    if before < 0:
        before = theirs
    approach, speed = x * u + y * v + z * w, u * u + v * v + w * w
    phase = APART
    if world.rules.response == NONE:
        end = now + passage((x, y, z), (u, v, w), reach).leave
        if inside and not were_apart(solid, k, p, before, theirs):
            phase = UNSURE
    else:
        end = now - approach / speed
    window = windows.add(open_, marks, k, p, now + wait, end, phase)
    if before >= 0:
        # no longer valid, but a good place to start from
        for seed in range(windows.SEEDS):
            open_.seeds[window, seed] = open_.seeds[before, seed]


@step
def were_apart(solid: SolidWorld, k: int, p: int, before: int, theirs: int) -> bool:
    """Whether the last window of two bodies stood until body k's last hit, and still waited for their contact."""
    open_, marks = solid.windows, solid.world.spheres.marks
    if before < 0:
        return False
    stood = open_.marks[before, OTHER_HITS] == (marks[k, HITS] - 1 if before == theirs else marks[p, HITS])
    return bool(stood and open_.marks[before, PHASE] in (APART, NEAR, DUE))


@step
def look_at_walls(solid: SolidWorld, k: int, now: float) -> None:
    """When body k's sphere meets the walls ahead of it."""
    world = solid.world
    rows = world.spheres.rows
    for axis in range(3):
        velocity = rows[k, VX + axis]
        radius = 0.5 * solid.body.sizes[k]
        phase = DUE
        if world.rules.response != NONE:
            radius *= 1.0 + 2.0 * solid.body.tolerance
            phase = APART
        plane = world.rules.half_box[axis] - radius
        wait = time_to_plane((plane if velocity > 0.0 else -plane) - rows[k, X + axis], velocity)
        solid.windows.wall_times[k, axis] = max(rows[k, TIME] + wait, now)
        solid.windows.wall_phases[k, axis] = phase


@step
def schedule(solid: SolidWorld, k: int, now: float) -> None:
    """The earliest of body k's windows, walls, cell faces and renewal goes to its leaf."""
    world, open_ = solid.world, solid.windows
    rows, cells, marks = world.spheres.rows, world.cells, world.spheres.marks
    due = inf
    kind = NOTHING
    held = NOBODY
    grid = marks[k, GRID]
    for axis in range(3):
        v = rows[k, VX + axis]
        up = 1 if v > 0.0 else 0
        face = next_face(cells, grid, axis, marks[k, PLACE + axis] + up, up) - rows[k, X + axis]
        time = rows[k, TIME] + time_to_plane(face, v)
        if time < due:
            due = time
            kind = CROSSING + 2 * axis + up
    if cells.shapes.shape[0] > 1 and cells.renewals[k] < due:
        due = cells.renewals[k]
        kind = RENEWAL
    for axis in range(3):
        time = open_.wall_times[k, axis]
        found = open_.wall_phases[k, axis] == DUE
        face_kind = WALL + 2 * axis + (1 if rows[k, VX + axis] > 0.0 else 0) if found else SEARCH
        if time < due or (time == due and time < inf and face_kind < kind):
            due = time
            kind = face_kind
            held = -1 - axis
    time, which = next_due(open_, marks, k)
    if which >= 0:
        pair_kind = PAIR if open_.marks[which, PHASE] == DUE else SEARCH
        if time < due or (time == due and pair_kind < kind):
            due = time
            kind = pair_kind
            held = which
    marks[k, KIND] = kind
    if kind == PAIR:
        marks[k, PARTNER] = open_.marks[held, OTHER]
    open_.held[k] = held
    world.agenda.times[world.agenda.times.size // 2 + k] = max(due, now)
