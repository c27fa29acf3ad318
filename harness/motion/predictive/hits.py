"""A pair touches, or a sphere meets a wall: velocities change, tallies are kept, the event is written down."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.burst import note_hit
from harness.motion.predictive.clock import absolute, catch_up
from harness.motion.predictive.response import bounce, flip
from harness.motion.predictive.state import ELASTIC, PAIR_EVENT, WALL_EVENT, World
from harness.motion.predictive.tally import add
from harness.narrowphase.spheres import approaches


@step
def hit_pair(world: World, k: int, p: int, now: float) -> bool:
    """Answer a pair if it still approaches. The labels order the two, so that it does not matter who held the event."""
    spheres, rules, tally = world.spheres, world.rules, world.tally
    motions, schedule, counts = spheres.motions, spheres.schedule, tally.counts[0]
    catch_up(world, k, now)
    catch_up(world, p, now)
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
    if rules.response == ELASTIC:
        restitution = rules.restitution
        if restitution < 1.0:
            # TC model: a contact so soon after another belongs to the same lasting contact, and loses nothing more
            if now - max(spheres.contacts[i], spheres.contacts[j]) < rules.contact_time:
                restitution = 1.0
                counts.guarded_hits += 1
            spheres.contacts[i] = now
            spheres.contacts[j] = now
        left = bounce(motions[i], motions[j], schedule[i].mass, schedule[j].mass, restitution)
        virial = left.virial
        if left.lost > 0.0:
            add(tally.sums[0].lost_energy, left.lost)
            add(tally.sums[0].lost_energy_time, left.lost * absolute(tally.clock[0], now))
    else:
        virial = flip(motions[i], motions[j], schedule[i].mass, schedule[j].mass)
    add(tally.sums[0].pair_virial, virial)
    note_hit(world, i, now, rules.blink)
    note_hit(world, j, now, rules.blink)
    counts.pair_hits += 1
    record(world, now, PAIR_EVENT, schedule[i].label, schedule[j].label, -1)
    return True


@step
def begin_to_touch(world: World, k: int, p: int, now: float) -> None:
    """Nothing answers: note the onset, once, although both spheres may hold it."""
    last = world.tally.onset[0]
    i = min(world.spheres.schedule[k].label, world.spheres.schedule[p].label)
    j = max(world.spheres.schedule[k].label, world.spheres.schedule[p].label)
    if now != last.time or i != last.i or j != last.j:
        last.time = now
        last.i = i
        last.j = j
        world.tally.counts[0].pair_hits += 1
        record(world, now, PAIR_EVENT, i, j, -1)


@step
def hit_wall(world: World, k: int, face: int, now: float) -> None:
    """A sphere meets a face (x-, x+, y-, y+, z-, z+)."""
    reach_plane(world, k, face, world.rules.half_box[face // 2] - world.spheres.motions[k].radius, now)
    turn_back(world, k, face, now)


@step
def reach_plane(world: World, k: int, face: int, plane: float, now: float) -> None:
    """Sphere k flies to the plane where it meets a face, at this distance from the middle of the box."""
    position = world.spheres.motions[k].position
    axis = face // 2
    inside = abs(position[axis]) <= plane
    catch_up(world, k, now)
    if inside:
        # Exactly on the plane: what time rounds away at any speed cannot add up to an escape
        position[axis] = plane if face % 2 == 1 else -plane


@step
def turn_back(world: World, k: int, face: int, now: float) -> None:
    """Mirror the velocity of sphere k, whose position is that of the present, at a face."""
    motion, tally = world.spheres.motions[k], world.tally
    axis = face // 2
    impulse = 2.0 * world.spheres.schedule[k].mass * abs(motion.velocity[axis])
    motion.velocity[axis] = -motion.velocity[axis]
    add(tally.walls[face], impulse)
    add(tally.sums[0].wall_virial, impulse * motion.position[axis] * (1.0 if face % 2 == 1 else -1.0))
    note_hit(world, k, now, 0.0)
    tally.counts[0].box_hits += 1
    record(world, now, WALL_EVENT, world.spheres.schedule[k].label, -1, face)


@step
def record(world: World, now: float, kind: int, i: int, j: int, wall: int) -> None:
    """Write an event down, if somebody reads it."""
    counts = world.tally.counts[0]
    if world.journal.size > 0:
        event = world.journal[counts.recorded]
        event.time = absolute(world.tally.clock[0], now)
        event.kind = kind
        event.i = i
        event.j = j
        event.wall = wall
        counts.recorded += 1
