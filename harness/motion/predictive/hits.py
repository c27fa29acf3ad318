"""What a hit does: velocities change, totals grow, and the event is recorded."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.burst import note_hit
from harness.motion.predictive.clock import absolute, advance
from harness.motion.predictive.codes import Event, ResponseCode
from harness.motion.predictive.response import answer_elastic, answer_reflect
from harness.motion.predictive.state import NOBODY, World
from harness.motion.predictive.sums import add
from harness.narrowphase.spheres import approaches


@step
def hit_pair(world: World, k: int, p: int, now: float) -> bool:
    """Answer a pair if it still approaches. Returns whether it did.

    The labels order the two, so that it does not matter who held the event.
    """
    spheres, rules, totals = world.spheres, world.rules, world.totals
    motions, schedule, counts = spheres.motions, spheres.schedule, totals.counts[0]
    advance(world, k, now)
    advance(world, p, now)
    gap = (
        motions[p].position[0] - motions[k].position[0],
        motions[p].position[1] - motions[k].position[1],
        motions[p].position[2] - motions[k].position[2],
    )
    velocity = (
        motions[p].velocity[0] - motions[k].velocity[0],
        motions[p].velocity[1] - motions[k].velocity[1],
        motions[p].velocity[2] - motions[k].velocity[2],
    )
    if not approaches(gap, velocity):
        return False
    swap = schedule[p].label < schedule[k].label
    i = p if swap else k
    j = k if swap else p
    note_before(world, i, j, now)
    if rules.response == ResponseCode.ELASTIC:
        restitution = rules.restitution
        if restitution < 1.0:
            row = max(count_in_row(world, i, now), count_in_row(world, j, now))
            if row >= rules.lasting:  # TC model: in a lasting contact no more energy is lost
                restitution = 1.0
                counts.guarded_hits += 1
        hit = answer_elastic(motions[i], motions[j], schedule[i].mass, schedule[j].mass, restitution)
        virial = hit.virial
        if hit.lost > 0.0:
            add(totals.sums[0].lost_energy, hit.lost)
            add(totals.sums[0].lost_energy_time, hit.lost * absolute(totals.clock[0], now))
    else:
        virial = answer_reflect(motions[i], motions[j], schedule[i].mass, schedule[j].mass)
    add(totals.sums[0].pair_virial, virial)
    note_hit(world, i, now, rules.burst_window)
    note_hit(world, j, now, rules.burst_window)
    counts.pair_hits += 1
    note_after(world, i, j)
    record(world, now, Event.PAIR, schedule[i].label, schedule[j].label, -1)
    return True


@step
def count_in_row(world: World, k: int, now: float) -> int:
    """How many pair hits of sphere k before this one came within the contact time of each other, and of this one."""
    contact = world.spheres.contacts[k]
    if now - contact.last < world.rules.contact_time:
        contact.row += 1
    else:
        contact.row = 0
    contact.last = now
    return int(contact.row)


@step
def note_onset(world: World, k: int, p: int, now: float) -> None:
    """Record that two spheres begin to touch where nothing answers: once, although both may hold the event."""
    last = world.totals.onset[0]
    i = min(world.spheres.schedule[k].label, world.spheres.schedule[p].label)
    j = max(world.spheres.schedule[k].label, world.spheres.schedule[p].label)
    if now != last.time or i != last.i or j != last.j:
        last.time = now
        last.i = i
        last.j = j
        world.totals.counts[0].pair_hits += 1
        first = k if world.spheres.schedule[k].label == i else p
        second = p if first == k else k
        note_before(world, first, second, now)
        note_after(world, first, second)
        record(world, now, Event.PAIR, i, j, -1)


@step
def hit_wall(world: World, k: int, face: int, now: float) -> None:
    """Reflect sphere k from the wall that it has reached: x-, x+, y-, y+, z-, z+."""
    advance_to_plane(world, k, face, world.rules.half_box[face // 2] - world.spheres.motions[k].radius, now)
    reflect_from_wall(world, k, face, now)


@step
def advance_to_plane(world: World, k: int, face: int, plane: float, now: float) -> None:
    """Move sphere k to the present, when its centre reaches a plane at this distance from the middle of the box."""
    position = world.spheres.motions[k].position
    axis = face // 2
    inside = abs(position[axis]) <= plane
    advance(world, k, now)
    if inside:
        # Exactly on the plane, so that what is rounded off the time cannot add up to an escape at any speed
        position[axis] = plane if face % 2 == 1 else -plane


@step
def reflect_from_wall(world: World, k: int, face: int, now: float) -> None:
    """Mirror the velocity of sphere k, whose position is that of the present, in a wall."""
    motion, totals = world.spheres.motions[k], world.totals
    axis = face // 2
    impulse = 2.0 * world.spheres.schedule[k].mass * abs(motion.velocity[axis])
    note_before(world, k, NOBODY, now)
    motion.velocity[axis] = -motion.velocity[axis]
    note_after(world, k, NOBODY)
    add(totals.wall_impulses[face], impulse)
    add(totals.sums[0].wall_virial, impulse * motion.position[axis] * (1.0 if face % 2 == 1 else -1.0))
    note_hit(world, k, now, 0.0)
    totals.counts[0].box_hits += 1
    record(world, now, Event.WALL, world.spheres.schedule[k].label, -1, face)


@step
def note_before(world: World, i: int, j: int, now: float) -> None:
    """Keep the states of spheres i and j, or of i alone, before the event that is recorded next, if they are kept."""
    if world.states.size > 0:
        state = world.states[world.totals.counts[0].recorded]
        state.now = now
        for place in range(2):
            k = i if place == 0 else j
            if k >= 0:
                motion = world.spheres.motions[k]
                state.time[place] = motion.time
                for axis in range(3):
                    state.position[place, axis] = motion.position[axis]
                    state.before[place, axis] = motion.velocity[axis]


@step
def note_after(world: World, i: int, j: int) -> None:
    """Keep their velocities after it."""
    if world.states.size > 0:
        state = world.states[world.totals.counts[0].recorded]
        for place in range(2):
            k = i if place == 0 else j
            if k >= 0:
                for axis in range(3):
                    state.after[place, axis] = world.spheres.motions[k].velocity[axis]


@step
def record(world: World, now: float, kind: int, i: int, j: int, wall: int) -> None:
    """Write an event into the log, if there is one."""
    counts = world.totals.counts[0]
    if world.log.size > 0:
        event = world.log[counts.recorded]
        event.time = absolute(world.totals.clock[0], now)
        event.kind = kind
        event.i = i
        event.j = j
        event.wall = wall
        counts.recorded += 1
