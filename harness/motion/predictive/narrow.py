"""The narrow search: when the shapes themselves touch, inside the window that their bounding spheres leave."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.solids import Solids, motion_of
from harness.motion.predictive.state import ADVANCES, BOX_TESTS, LABEL, NARROW_TESTS, STALLED, VX, World
from harness.motion.predictive.windows import DUE, OTHER, PARTING, PHASE, TOUCHING, UNSURE, Windows, remove
from harness.narrowphase.advancement import IMPACT, NEVER, time_of_impact, time_of_wall_impact
from harness.narrowphase.parting import time_of_parting


@step
def search_pair(world: World, body: Solids, windows: Windows, k: int, w: int, now: float) -> None:
    """Find the hit of body k in its window w, which is due; close the window if there is none."""
    rows, body_marks, counts = world.spheres.rows, world.spheres.marks, world.tally.counts
    p = int(windows.marks[w, OTHER])
    # The labels order the two, so that it does not matter who holds the window
    swap = body_marks[p, LABEL] < body_marks[k, LABEL]
    i = p if swap else k
    j = k if swap else p
    a, b = motion_of(body, rows, i, now), motion_of(body, rows, j, now)
    tolerance = 0.5 * body.tolerance * (a.size + b.size)
    left = max(windows.ends[w] - now, 0.0)
    seeds = windows.seeds
    start = (seeds[w, 0], seeds[w, 1], seeds[w, 2], seeds[w, 3])
    touching = windows.marks[w, PHASE] == TOUCHING
    if touching:
        found = time_of_parting(body.hull, body.inradius, a, b, 0.0, left, 2.0 * tolerance, start)
    else:
        found = time_of_impact(body.hull, body.hull, a, b, 0.0, left, tolerance, start)
    for seed in range(4):
        seeds[w, seed] = found.seeds[seed]
    counts[NARROW_TESTS] += 1
    counts[ADVANCES] += found.steps
    if found.verdict == NEVER:
        remove(windows, k, w)
        return
    windows.times[w] = now + found.time
    if found.verdict == IMPACT:
        if touching:
            windows.marks[w, PHASE] = PARTING
        elif windows.marks[w, PHASE] == UNSURE and found.time == 0.0:
            windows.marks[w, PHASE] = TOUCHING
        else:
            windows.marks[w, PHASE] = DUE
    elif found.time < world.rules.pause:
        windows.times[w] = now + world.rules.pause
        counts[STALLED] += 1


@step
def search_wall(world: World, body: Solids, windows: Windows, k: int, axis: int, now: float) -> None:
    """Find the hit of body k on the wall ahead along an axis."""
    counts, rules = world.tally.counts, world.rules
    face = 2 * axis + (1 if world.spheres.rows[k, VX + axis] > 0.0 else 0)
    flight = motion_of(body, world.spheres.rows, k, now)
    found = time_of_wall_impact(
        body.hull, flight, face, body.scale * rules.half_box[axis], 0.0, 1e300, body.tolerance * flight.size
    )
    counts[BOX_TESTS] += 1
    counts[ADVANCES] += found.steps
    windows.wall_times[k, axis] = now + found.time
    if found.verdict == IMPACT:
        windows.wall_phases[k, axis] = DUE
    elif found.time < rules.pause:
        windows.wall_times[k, axis] = now + rules.pause
        counts[STALLED] += 1
