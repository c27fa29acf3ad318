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
from harness.motion.predictive.cells import ALL, AROUND, Layer, insert, next_face, remove
from harness.motion.predictive.clock import catch_up, relative
from harness.motion.predictive.clock import shift as shift_spheres
from harness.motion.predictive.flight import CROWDED, FULL, REACHED, SPENT
from harness.motion.predictive.hits import begin_to_touch, hit_pair, reach_plane, turn_back
from harness.motion.predictive.narrow import search_pair, search_wall
from harness.motion.predictive.numerics import time_to_plane
from harness.motion.predictive.solids import SolidWorld, turn_to_base
from harness.motion.predictive.state import CROSSING, FRESH, NONE, NOTHING, PAIR, RENEWAL, SEARCH, WALL
from harness.motion.predictive.surroundings import gather
from harness.motion.predictive.windows import APART, DUE, NEAR, NOBODY, TOUCHING, UNSURE, find, holds, next_due
from harness.narrowphase.spheres import passage, time_to_touch

# What a body must do after an event: look at all around it anew, look only for whom it does not know yet, or neither.
ANEW, MORE, SAME = range(3)


class Aftermath(NamedTuple):
    """What is to be done after an event.

    task : ANEW, MORE or SAME
    other : the other body that must do so, or `NOBODY`
    layer : the cells that are new to those who look
    """

    task: int
    other: int
    layer: Layer


@kernel
def fly_solids(solid: SolidWorld, until: float, budget: int) -> int:
    """Let everything happen that is due up to and including `until` (s), or until `budget` hits are answered in all."""
    world = solid.world
    agenda, counts, clock = world.agenda, world.tally.counts[0], world.tally.clock[0]
    limit = relative(clock, until)
    while True:
        k = int(agenda.winners[1])
        now = agenda.times[1]
        if not now <= limit or now == inf:
            return REACHED
        if counts.pair_hits + counts.box_hits >= budget:
            return SPENT
        if solid.windows.free[0].count < 2 * world.spheres.motions.size:
            return CROWDED
        if counts.since_rebasing >= world.rules.span and now > clock.now:
            windows.shift(solid.windows, clock.now)
            shift_spheres(world)
            turn_to_base(solid.body, clock)
            limit = relative(clock, until)
            continue
        if counts.recorded == world.journal.size and counts.recorded > 0:
            return FULL
        clock.now = now
        counts.since_rebasing += 1
        after = Aftermath(SAME, NOBODY, AROUND)
        if world.spheres.schedule[k].kind == SEARCH:
            search(solid, k, now)
        else:
            after = happen(solid, k, now)
        for turn in range(2):
            who = k if turn == 0 else after.other
            if who >= 0:
                if after.task != SAME:
                    look(solid, who, now, after.task == ANEW, after.layer)
                schedule_next(solid, who, now)
                tournament.replay(agenda, world.spheres.schedule, who)


@kernel
def search(solid: SolidWorld, k: int, now: float) -> None:
    """Carry out the search that body k's event is."""
    held = int(solid.windows.held[k])
    if held < 0:
        search_wall(solid, k, -1 - held, now)
    elif holds(solid.windows, solid.world.spheres.schedule, held):
        search_pair(solid, k, held, now)
    else:
        windows.remove(solid.windows, k, held)
        solid.world.tally.counts[0].stale_events += 1


@step
def happen(solid: SolidWorld, k: int, now: float) -> Aftermath:
    """Carry out body k's event, other than a search."""
    world = solid.world
    schedule, counts = world.spheres.schedule, world.tally.counts[0]
    kind = int(schedule[k].kind)
    task = SAME
    other = NOBODY
    axis = ALL
    step = 0
    if kind == PAIR:
        held = int(solid.windows.held[k])
        if not holds(solid.windows, schedule, held):
            windows.remove(solid.windows, k, held)
            counts.stale_events += 1
        elif meet(solid, k, held, now):
            task = ANEW
            other = int(solid.windows.pool[held].other)
    elif kind >= WALL and kind < CROSSING:
        if meet_wall(solid, k, kind - WALL, now):
            task = ANEW
    elif kind >= CROSSING and kind < RENEWAL:
        axis = (kind - CROSSING) // 2
        step = 2 * ((kind - CROSSING) % 2) - 1
        remove(world.cells, schedule, k)
        schedule[k].cell[axis] += step
        insert(world.cells, schedule, k)
        counts.cell_crossings += 1
        task = MORE
    else:
        task = ANEW if kind == FRESH else MORE
    return Aftermath(task, other, Layer(axis, step))


@step
def meet(solid: SolidWorld, k: int, w: int, now: float) -> bool:
    """Body k and the other of its window w touch. Returns whether they answer."""
    world, window = solid.world, solid.windows.pool[w]
    p = int(window.other)
    wait = max(patience(world, k, now), patience(world, p, now))
    if wait > 0.0:
        window.time = now + wait
        world.tally.counts[0].stalled_events += 1
        return False
    if world.rules.response == NONE:
        begin_to_touch(world, k, p, now)
        window.phase = TOUCHING
        return False
    if hit_pair(world, k, p, now):
        return True
    windows.remove(solid.windows, k, w)
    return False


@step
def meet_wall(solid: SolidWorld, k: int, face: int, now: float) -> bool:
    """Body k touches a wall, or its sphere does where only that is reflected. Returns whether it turns back."""
    world = solid.world
    axis = face // 2
    wait = patience(world, k, now)
    if wait > 0.0:
        solid.windows.walls[k, axis].time = now + wait
        world.tally.counts[0].stalled_events += 1
        return False
    if world.rules.response == NONE:
        reach_plane(world, k, face, world.rules.half_box[axis] - 0.5 * solid.body.sizes[k], now)
    else:
        catch_up(world, k, now)
    turn_back(world, k, face, now)
    return True


@step
def look(solid: SolidWorld, k: int, now: float, anew: bool, layer: Layer) -> None:
    """Open body k's windows: on everybody around it, or on those it does not know yet."""
    world = solid.world
    known = int(solid.windows.heads[k])
    if anew:
        solid.windows.heads[k] = NOBODY
        look_at_walls(solid, k, now)
        world.tally.counts[0].predictions += 1
    count = gather(world, k, now, layer)
    world.tally.counts[0].pair_tests += count - (layer.axis == ALL)
    for m in range(count):
        p = int(world.scratch.found[m])
        if p != k:
            open_window(solid, k, p, now, anew, known)
    if anew:
        windows.close_all(solid.windows, known)


@step
def open_window(solid: SolidWorld, k: int, p: int, now: float, anew: bool, known: int) -> None:
    """Open body k's window on body p, if their spheres meet and neither holds one on the other that stands."""
    world, open_ = solid.world, solid.windows
    schedule = world.spheres.schedule
    own, other = world.spheres.motions[k], world.spheres.motions[p]
    flown, flown_p = now - own.time, now - other.time
    x = (other.position[0] + other.velocity[0] * flown_p) - (own.position[0] + own.velocity[0] * flown)
    y = (other.position[1] + other.velocity[1] * flown_p) - (own.position[1] + own.velocity[1] * flown)
    z = (other.position[2] + other.velocity[2] * flown_p) - (own.position[2] + own.velocity[2] * flown)
    u = other.velocity[0] - own.velocity[0]
    v = other.velocity[1] - own.velocity[1]
    w = other.velocity[2] - own.velocity[2]
    reach = own.radius + other.radius
    inside = x * x + y * y + z * z <= reach * reach
    wait = time_to_touch((x, y, z), (u, v, w), reach)
    if world.rules.response == NONE and inside:
        wait = 0.0
    if wait == inf:
        return
    theirs = find(open_, open_.heads[p], k)
    if holds(open_, schedule, theirs) or (not anew and holds(open_, schedule, find(open_, known, p))):
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
    new = windows.add(open_, schedule, k, p)
    open_.pool[new].time = now + wait
    open_.pool[new].end = end
    open_.pool[new].phase = phase
    if before >= 0:
        open_.starts[new] = open_.starts[before]  # no longer valid, but a good place to start from


@step
def were_apart(solid: SolidWorld, k: int, p: int, before: int, theirs: int) -> bool:
    """Whether the last window of two bodies stood until body k's last hit, and still waited for their contact."""
    if before < 0:
        return False
    schedule, last = solid.world.spheres.schedule, solid.windows.pool[before]
    stood = last.other_hits == (schedule[k].hits - 1 if before == theirs else schedule[p].hits)
    return bool(stood and last.phase in (APART, NEAR, DUE))


@step
def look_at_walls(solid: SolidWorld, k: int, now: float) -> None:
    """When body k's sphere meets the walls ahead of it."""
    world, motion = solid.world, solid.world.spheres.motions[k]
    for axis in range(3):
        velocity = motion.velocity[axis]
        radius = 0.5 * solid.body.sizes[k]
        phase = DUE
        if world.rules.response != NONE:
            radius *= 1.0 + 2.0 * solid.body.tolerance
            phase = APART
        plane = world.rules.half_box[axis] - radius
        wait = time_to_plane((plane if velocity > 0.0 else -plane) - motion.position[axis], velocity)
        solid.windows.walls[k, axis].time = max(motion.time + wait, now)
        solid.windows.walls[k, axis].phase = phase


@step
def schedule_next(solid: SolidWorld, k: int, now: float) -> None:
    """The earliest of body k's windows, walls, cell faces and renewal goes to its leaf."""
    world, open_, cells = solid.world, solid.windows, solid.world.cells
    motion, own = world.spheres.motions[k], world.spheres.schedule[k]
    due = inf
    kind = NOTHING
    held = NOBODY
    grid = cells.grids[own.size_class]
    for axis in range(3):
        v = motion.velocity[axis]
        up = 1 if v > 0.0 else 0
        face = next_face(grid, axis, own.cell[axis] + up, up) - motion.position[axis]
        time = motion.time + time_to_plane(face, v)
        if time < due:
            due = time
            kind = CROSSING + 2 * axis + up
    if cells.grids.size > 1 and cells.renewals[k] < due:
        due = cells.renewals[k]
        kind = RENEWAL
    for axis in range(3):
        wall = open_.walls[k, axis]
        time = wall.time
        face_kind = WALL + 2 * axis + (1 if motion.velocity[axis] > 0.0 else 0) if wall.phase == DUE else SEARCH
        if time < due or (time == due and time < inf and face_kind < kind):
            due = time
            kind = face_kind
            held = -1 - axis
    which = next_due(open_, world.spheres.schedule, k)
    if which >= 0:
        time = open_.pool[which].time
        pair_kind = PAIR if open_.pool[which].phase == DUE else SEARCH
        if time < due or (time == due and pair_kind < kind):
            due = time
            kind = pair_kind
            held = which
    own.kind = kind
    if kind == PAIR:
        own.partner = open_.pool[held].other
    open_.held[k] = held
    world.agenda.times[world.agenda.times.size // 2 + k] = max(due, now)
