"""The event loop of spheres: take the next event, carry it out, predict the next event of whom it concerned.

Each sphere holds one event, its own earliest; a pair event is held by whichever of the two predicted last, with the
number of the event after which it did. A held event can only be too early (the partner flew elsewhere), never too late:
whoever changes its velocity looks at all its neighbours. So an event that turns out stale costs one more prediction and
nothing else.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from harness.kernel import loop, step
from harness.motion.predictive import tournament
from harness.motion.predictive.burst import defer_if_stalled
from harness.motion.predictive.candidates import gather_candidates
from harness.motion.predictive.cells import AROUND, cross, insert, insert_by_position, next_face
from harness.motion.predictive.clock import advance, rebase, relative
from harness.motion.predictive.codes import Event, NeighbourSearch, ResponseCode, Stop, Task
from harness.motion.predictive.events import FollowUp, begin, enqueue, reason_to_stop
from harness.motion.predictive.exit_times import time_to_leave, time_to_plane
from harness.motion.predictive.hits import hit_pair, hit_wall, note_onset
from harness.motion.predictive.ignored import without_ignored
from harness.motion.predictive.larger import register_all, register_anew
from harness.motion.predictive.lookahead import prefetch_ahead, prefetch_next
from harness.motion.predictive.neighbours import renew, settle
from harness.motion.predictive.pair_search import first_onset, first_touch
from harness.motion.predictive.state import NOBODY, World


@loop
def populate(world: World, placed: bool) -> bool:
    """Put all spheres into their cells and rebuild the event queue. Returns False if a cell has no room.

    Those with neighbour lists go into the cells of their anchors. Of others, placed spheres go into the cells that
    their records name, the rest into those where their positions are.
    """
    for k in range(world.spheres.motions.size):
        if world.rules.neighbours == NeighbourSearch.LISTS:
            if not settle(world, k):
                return False
        elif placed:
            insert(world.cells, world.spheres.schedule, k)
        else:
            insert_by_position(world.cells, world.spheres, k)
    register_all(world, placed)
    tournament.rebuild(world.queue, world.spheres.schedule)
    return True


def event_loop(deep: bool, several: bool) -> Callable[[World, float, int], Stop]:
    """The event loop, for so many spheres that the event queue is out of the caches (`deep`), for `several` grids.

    Each is compiled by itself, as code for prefetching that did not run cost small numbers of spheres 2 to 9 % of the
    rate, and code for several grids 3 %.
    """

    @loop
    def fly(world: World, until: float, budget: int) -> Stop:
        """Let everything happen that is due up to and including `until` (s), or until `budget` hits are answered."""
        queue, rules, clock = world.queue, world.rules, world.totals.clock[0]
        limit = relative(clock, until)
        while True:
            stop = reason_to_stop(world, limit, budget)
            if stop == Stop.REBASE:
                rebase(world)
                limit = relative(clock, until)
                if rules.bases_per_order > 0 and world.totals.counts[0].rebasings % rules.bases_per_order == 0:
                    return Stop.REORDER
                continue
            if stop != Stop.NOT:
                return stop
            k = int(queue.winners[1])
            now = queue.times[1]
            if defer_if_stalled(world, k, now):
                continue
            begin(world, now)
            after = process_event(world, k, now, several)
            if after.task == Task.GIVE_UP:
                return Stop.NO_ROOM
            # One call for the one or two spheres concerned, as the search is inlined wherever it is called
            for turn in range(2):
                who = k if turn == 0 else after.other
                if who >= 0:
                    predict(world, who, now, after, several)
                    schedule_next(world, who, now, several)
                    if rules.prefetching:
                        prefetch_ahead(world, who, deep)
                    else:
                        prefetch_next(world, who)

    return fly


fly = event_loop(deep=False, several=False)
fly_deep = event_loop(deep=True, several=False)
fly_several = event_loop(deep=False, several=True)
fly_several_deep = event_loop(deep=True, several=True)


@step
def process_event(world: World, k: int, now: float, several: bool) -> FollowUp:
    """Carry out the event that sphere k holds."""
    schedule, counts = world.spheres.schedule, world.totals.counts[0]
    own = schedule[k]
    task = Task.PREDICT
    other = NOBODY
    layer = AROUND
    if own.kind == Event.PAIR:
        p = int(own.partner)
        if schedule[p].changed <= own.predicted:
            if world.rules.response == ResponseCode.NONE:
                note_onset(world, k, p, now)
            elif hit_pair(world, k, p, now):
                other = p
        else:
            counts.stale_events += 1
    elif own.kind == Event.WALL:
        hit_wall(world, k, own.face, now)
    elif own.kind == Event.CROSSING:
        task = Task.EXTEND
        layer = cross(world.cells, schedule, k)
        counts.cell_crossings += 1
    elif world.rules.neighbours == NeighbourSearch.LISTS:
        advance(world, k, now)
        counts.list_renewals += 1
        if not renew(world, k):
            task = Task.GIVE_UP
    elif several and own.kind == Event.RENEWAL:
        register_anew(world, k, now)
    return FollowUp(task, other, layer)


@step
def predict(world: World, k: int, now: float, after: FollowUp, several: bool) -> None:
    """Find sphere k's next pair event.

    After a crossing its pair candidate stands, and only the new layer of cells is searched.
    """
    schedule, counts = world.spheres.schedule, world.totals.counts[0]
    own = schedule[k]
    candidates = world.scratch.found
    if world.rules.neighbours == NeighbourSearch.LISTS:
        count = int(world.lists.members[k].count)
        candidates = world.lists.members[k].who[:]
    else:
        count = without_ignored(world, k, candidates, gather_candidates(world, k, now, after.layer, several))
        counts.pair_tests -= after.task == Task.PREDICT  # itself among them: zero gap, no hit
    counts.pair_tests += count
    if world.rules.response == ResponseCode.NONE:
        found = first_onset(world, k, now, candidates, count)
    else:
        found = first_touch(world, k, now, candidates, count)
    known = own.pair_time
    if after.task == Task.PREDICT:
        counts.predictions += 1
        known = inf
    time, partner = found.time, found.partner
    tie = time == known and time < inf and schedule[partner].label < schedule[own.partner].label
    if after.task == Task.PREDICT or time < known or tie:
        own.pair_time = time
        own.partner = partner
        own.predicted = counts.since_rebasing


@step
def schedule_next(world: World, k: int, now: float, several: bool) -> None:
    """Schedule the earliest of sphere k's pair candidate, walls, cell faces and renewal."""
    own = world.spheres.schedule[k]
    due = own.pair_time
    if world.rules.neighbours == NeighbourSearch.LISTS and stays(world, k, due):
        own.kind = Event.PAIR
    else:
        due = choose_next(world, k, several)
    enqueue(world, k, max(due, now))


@step
def stays(world: World, k: int, time: float) -> bool:
    """Whether sphere k is still within its walls and near its anchor at a time; no division tells when it leaves them.

    Where rounding could decide, the answer is no.
    """
    motion, anchors, rules = world.spheres.motions[k], world.lists.anchors, world.rules
    flown = time - motion.time
    inside = flown < inf
    square = 0.0
    for axis in range(3):
        x = motion.position[axis] + motion.velocity[axis] * flown
        inside &= abs(x) < (rules.half_box[axis] - motion.radius) * (1.0 - 1e-12)
        off = x - anchors[k, axis]
        square += off * off
    return bool(inside & (square < 0.2498 * rules.skin * rules.skin))


@step
def choose_next(world: World, k: int, several: bool) -> float:
    """Note the earliest of sphere k's pair candidate, walls, cell faces and renewal. Returns when it is due, s."""
    cells, rules = world.cells, world.rules
    motion, own = world.spheres.motions[k], world.spheres.schedule[k]
    begin = motion.time
    due = inf
    kind = Event.NOTHING
    met = 0
    grid = cells.grids[own.size_class]
    for axis in range(3):
        x = motion.position[axis]
        v = motion.velocity[axis]
        up = 1 if v > 0.0 else 0
        plane = rules.half_box[axis] - motion.radius
        if rules.neighbours == NeighbourSearch.LISTS and abs(world.lists.anchors[k, axis]) + rules.skin < plane:
            continue  # the list must be renewed before the wall can be reached
        distance = (plane if v > 0.0 else -plane) - x
        target = Event.WALL
        if rules.neighbours == NeighbourSearch.CELLS:
            face = next_face(grid, axis, own.cell[axis] + up, up) - x
            if (face < distance) == (v > 0.0):
                distance = face
                target = Event.CROSSING
        time = begin + time_to_plane(distance, v)
        if time < due:
            due = time
            kind = target
            met = 2 * axis + up
    renewal = inf
    if rules.neighbours == NeighbourSearch.LISTS:
        # A little early, so that rounding cannot make it late
        anchors = world.lists.anchors
        renewal = time_to_leave(anchors[k, 0], anchors[k, 1], anchors[k, 2], motion, 0.2499 * rules.skin * rules.skin)
    elif several:
        renewal = cells.renewals[k]
    if renewal < due:
        due = renewal
        kind = Event.RENEWAL
    if own.pair_time <= due:
        due = own.pair_time
        kind = Event.PAIR if due < inf else Event.NOTHING
    own.kind = kind
    own.face = met
    return due
