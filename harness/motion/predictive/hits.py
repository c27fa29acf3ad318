"""A pair touches, or a sphere meets a wall: velocities change, tallies are kept, the event is written down."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.burst import note_hit
from harness.motion.predictive.clock import catch_up
from harness.motion.predictive.response import bounce, flip
from harness.motion.predictive.state import (
    BOX_HITS,
    ELASTIC,
    FACES,
    GUARDED,
    LABEL,
    LOST_ENERGY,
    LOST_ENERGY_TIME,
    MARK,
    MARK_I,
    MARK_J,
    MASS,
    PAIR_HITS,
    PAIR_VIRIAL,
    RADIUS,
    RECORDED,
    VX,
    WALL_VIRIAL,
    World,
    X,
)
from harness.motion.predictive.tally import absolute, add
from harness.narrowphase.spheres import approaches


@step
def hit_pair(world: World, k: int, p: int, now: float) -> bool:
    """Answer a pair if it still approaches. The labels order the two, so that it does not matter who held the event."""
    spheres, rules, tally = world.spheres, world.rules, world.tally
    rows = spheres.rows
    catch_up(world, k, now)
    catch_up(world, p, now)
    gap = rows[p, X] - rows[k, X], rows[p, X + 1] - rows[k, X + 1], rows[p, X + 2] - rows[k, X + 2]
    velocity = rows[p, VX] - rows[k, VX], rows[p, VX + 1] - rows[k, VX + 1], rows[p, VX + 2] - rows[k, VX + 2]
    if not approaches(gap, velocity):
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
    """A sphere meets a face (x-, x+, y-, y+, z-, z+)."""
    reach_plane(world, k, face, world.rules.half_box[face // 2] - world.spheres.rows[k, RADIUS], now)
    turn_back(world, k, face, now)


@step
def reach_plane(world: World, k: int, face: int, plane: float, now: float) -> None:
    """Sphere k flies to the plane where it meets a face, at this distance from the middle of the box."""
    rows = world.spheres.rows
    axis = face // 2
    inside = abs(rows[k, X + axis]) <= plane
    catch_up(world, k, now)
    if inside:
        # Exactly on the plane: what time rounds away at any speed cannot add up to an escape
        rows[k, X + axis] = plane if face % 2 == 1 else -plane


@step
def turn_back(world: World, k: int, face: int, now: float) -> None:
    """Mirror the velocity of sphere k, whose row stands at the present, at a face."""
    rows, tally = world.spheres.rows, world.tally
    axis = face // 2
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
