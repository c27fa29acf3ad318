"""The event loop of bodies of any shape: a contact is searched for while their bounding spheres can touch.

It is the loop of spheres with one kind of event more, the search. A body holds all its windows, not the earliest one
alone, so that no search is done twice. The loop itself is a strict kernel, as those of the narrow phase, which it
calls, are compiled as it is: they need memory of their own, and exact rounding.
"""

from __future__ import annotations

from math import inf

from harness.kernel import kernel, step
from harness.motion.predictive.burst import cooldown
from harness.motion.predictive.candidates import gather_candidates
from harness.motion.predictive.cells import ALL, AROUND, cross, next_face
from harness.motion.predictive.clock import advance, relative, shift_times
from harness.motion.predictive.codes import Event, Phase, ResponseCode, Stop, Task
from harness.motion.predictive.events import FollowUp, begin, enqueue, reason_to_stop
from harness.motion.predictive.exit_times import time_to_plane
from harness.motion.predictive.hits import advance_to_plane, hit_pair, note_onset, reflect_from_wall
from harness.motion.predictive.ignored import without_ignored
from harness.motion.predictive.larger import register_anew
from harness.motion.predictive.narrow_search import search_pair, search_wall
from harness.motion.predictive.solids import SolidWorld, turn_to_base
from harness.motion.predictive.state import NOBODY
from harness.motion.predictive.windows import close, close_all, find, next_due, open_on, shift_windows, valid
from harness.narrowphase.spheres import passage, time_to_touch


@kernel
def fly_solids(solid: SolidWorld, until: float, budget: int) -> Stop:
    """Let everything happen that is due up to and including `until` (s), or until `budget` hits are answered in all."""
    world = solid.world
    queue, schedule, clock = world.queue, world.spheres.schedule, world.totals.clock[0]
    limit = relative(clock, until)
    while True:
        stop = reason_to_stop(world, limit, budget)
        if stop == Stop.REBASE:
            shift_windows(solid.windows, clock.now)
            shift_times(world)
            turn_to_base(solid.body, clock)
            limit = relative(clock, until)
            continue
        if stop != Stop.NOT:
            return stop
        if solid.windows.free[0].count < 2 * schedule.size:
            return Stop.NO_ROOM
        k = int(queue.winners[1])
        now = queue.times[1]
        begin(world, now)
        after = FollowUp(Task.KEEP, NOBODY, AROUND)
        if schedule[k].kind == Event.SEARCH:
            search(solid, k, now)
        else:
            after = process_event(solid, k, now)
        for turn in range(2):
            who = k if turn == 0 else after.other
            if who >= 0:
                if after.task != Task.KEEP:
                    predict(solid, who, now, after)
                schedule_next(solid, who, now)


@kernel
def search(solid: SolidWorld, k: int, now: float) -> None:
    """Carry out the search that body k holds."""
    held = int(solid.windows.held[k])
    if held < 0:
        search_wall(solid, k, -1 - held, now)
    elif valid(solid.windows, solid.world.spheres.schedule, held):
        search_pair(solid, k, held, now)
    else:
        close(solid.windows, k, held)
        solid.world.totals.counts[0].stale_events += 1


@step
def process_event(solid: SolidWorld, k: int, now: float) -> FollowUp:
    """Carry out the event that body k holds, other than a search."""
    world = solid.world
    schedule, counts = world.spheres.schedule, world.totals.counts[0]
    own = schedule[k]
    task = Task.KEEP
    other = NOBODY
    layer = AROUND
    if own.kind == Event.PAIR:
        held = int(solid.windows.held[k])
        if not valid(solid.windows, schedule, held):
            close(solid.windows, k, held)
            counts.stale_events += 1
        elif answer_pair(solid, k, held, now):
            task = Task.PREDICT
            other = int(own.partner)
    elif own.kind == Event.WALL:
        if answer_wall(solid, k, own.face, now):
            task = Task.PREDICT
    elif own.kind == Event.CROSSING:
        task = Task.EXTEND
        layer = cross(world.cells, schedule, k)
        counts.cell_crossings += 1
    elif own.kind == Event.UNSCHEDULED:
        task = Task.PREDICT
    else:
        register_anew(world, k, now)
        task = Task.EXTEND
    return FollowUp(task, other, layer)


@step
def answer_pair(solid: SolidWorld, k: int, w: int, now: float) -> bool:
    """Body k and the other of its window w touch. Returns whether their velocities change."""
    world, window = solid.world, solid.windows.pool[w]
    p = int(window.other)
    wait = max(cooldown(world, k, now), cooldown(world, p, now))
    if wait > 0.0:
        window.time = now + wait
        world.totals.counts[0].stalled_events += 1
        return False
    if world.rules.response == ResponseCode.NONE:
        note_onset(world, k, p, now)
        window.phase = Phase.TOUCHING
        return False
    if hit_pair(world, k, p, now):
        return True
    close(solid.windows, k, w)
    return False


@step
def answer_wall(solid: SolidWorld, k: int, face: int, now: float) -> bool:
    """Body k touches a wall, or its sphere does where only that is reflected. Returns whether its velocity changes."""
    world = solid.world
    axis = face // 2
    wait = cooldown(world, k, now)
    if wait > 0.0:
        solid.windows.walls[k, axis].time = now + wait
        world.totals.counts[0].stalled_events += 1
        return False
    if world.rules.response == ResponseCode.NONE:
        advance_to_plane(world, k, face, world.rules.half_box[axis] - 0.5 * solid.body.sizes[k], now)
    else:
        advance(world, k, now)
    reflect_from_wall(world, k, face, now)
    return True


@step
def predict(solid: SolidWorld, k: int, now: float, after: FollowUp) -> None:
    """Open body k's windows: on everybody around it, or only on those who are new to it."""
    world, windows = solid.world, solid.windows
    anew = after.task == Task.PREDICT
    known = int(windows.heads[k])
    if anew:
        windows.heads[k] = NOBODY
        open_wall_windows(solid, k, now)
        world.totals.counts[0].predictions += 1
    count = gather_candidates(world, k, now, after.layer, world.cells.grids.size > 1)
    count = without_ignored(world, k, world.scratch.found, count)
    world.totals.counts[0].pair_tests += count - (after.layer.axis == ALL)
    for m in range(count):
        p = int(world.scratch.found[m])
        if p != k:
            open_window(solid, k, p, now, anew, known)
    if anew:
        close_all(windows, known)


@step
def open_window(solid: SolidWorld, k: int, p: int, now: float, anew: bool, known: int) -> None:
    """Open body k's window on body p, if their spheres will touch and neither holds a valid one on the other.

    Parameters
    ----------
    anew : whether body k's windows from before its last hit are closed after this
    known : the first of the windows that it has had so far
    """
    world, windows = solid.world, solid.windows
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
    if world.rules.response == ResponseCode.NONE and inside:
        wait = 0.0
    if wait == inf:
        return
    theirs = find(windows, windows.heads[p], k)
    if valid(windows, schedule, theirs) or (not anew and valid(windows, schedule, find(windows, known, p))):
        return
    before = find(windows, known, p) if anew else NOBODY
    if before < 0:
        before = theirs
    approach, speed = x * u + y * v + z * w, u * u + v * v + w * w
    phase = Phase.APART
    if world.rules.response == ResponseCode.NONE:
        # the window lasts as long as the spheres overlap
        end = now + passage((x, y, z), (u, v, w), reach).leave
        if inside and not were_apart(solid, k, p, before, theirs):
            phase = Phase.UNSURE
    else:
        end = now - approach / speed
    new = open_on(windows, schedule, k, p)
    windows.pool[new].time = now + wait
    windows.pool[new].end = end
    windows.pool[new].phase = phase
    if before >= 0:
        windows.warm_starts[new] = windows.warm_starts[before]


@step
def were_apart(solid: SolidWorld, k: int, p: int, before: int, theirs: int) -> bool:
    """Whether the last window of two bodies was valid until body k's last hit, and still waited for their contact.

    It is body p's if it is the one that is called `theirs`.
    """
    if before < 0:
        return False
    schedule, last = solid.world.spheres.schedule, solid.windows.pool[before]
    was_valid = last.other_hits == (schedule[k].hits - 1 if before == theirs else schedule[p].hits)
    return bool(was_valid and last.phase in (Phase.APART, Phase.NEAR, Phase.DUE))


@step
def open_wall_windows(solid: SolidWorld, k: int, now: float) -> None:
    """When body k's sphere touches the walls ahead of it."""
    world, motion = solid.world, solid.world.spheres.motions[k]
    for axis in range(3):
        velocity = motion.velocity[axis]
        radius = 0.5 * solid.body.sizes[k]
        phase = Phase.DUE
        if world.rules.response != ResponseCode.NONE:
            radius *= 1.0 + 2.0 * solid.body.tolerance
            phase = Phase.APART
        plane = world.rules.half_box[axis] - radius
        wait = time_to_plane((plane if velocity > 0.0 else -plane) - motion.position[axis], velocity)
        solid.windows.walls[k, axis].time = max(motion.time + wait, now)
        solid.windows.walls[k, axis].phase = phase


@step
def schedule_next(solid: SolidWorld, k: int, now: float) -> None:
    """Schedule the earliest of body k's windows, walls, cell faces and renewal."""
    world, windows, cells = solid.world, solid.windows, solid.world.cells
    motion, own = world.spheres.motions[k], world.spheres.schedule[k]
    due = inf
    kind = Event.NOTHING
    met = 0
    held = NOBODY
    grid = cells.grids[own.size_class]
    for axis in range(3):
        v = motion.velocity[axis]
        up = 1 if v > 0.0 else 0
        face = next_face(grid, axis, own.cell[axis] + up, up) - motion.position[axis]
        time = motion.time + time_to_plane(face, v)
        if time < due:
            due = time
            kind = Event.CROSSING
            met = 2 * axis + up
    if cells.grids.size > 1 and cells.renewals[k] < due:
        due = cells.renewals[k]
        kind = Event.RENEWAL
    for axis in range(3):
        time = windows.walls[k, axis].time
        wall_kind = Event.WALL if windows.walls[k, axis].phase == Phase.DUE else Event.SEARCH
        if time < due or (time == due and time < inf and wall_kind < kind):
            due = time
            kind = wall_kind
            met = 2 * axis + (1 if motion.velocity[axis] > 0.0 else 0)
            held = -1 - axis
    which = next_due(windows, world.spheres.schedule, k)
    if which >= 0:
        time = windows.pool[which].time
        pair_kind = Event.PAIR if windows.pool[which].phase == Phase.DUE else Event.SEARCH
        if time < due or (time == due and pair_kind < kind):
            due = time
            kind = pair_kind
            held = which
    own.kind = kind
    own.face = met
    if kind == Event.PAIR:
        own.partner = windows.pool[held].other
    windows.held[k] = held
    enqueue(world, k, max(due, now))
