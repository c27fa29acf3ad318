"""The narrow search: when the shapes themselves touch, inside the window that their bounding spheres leave."""

from __future__ import annotations

from harness.kernel import kernel
from harness.motion.predictive.solids import Solids, motion_of
from harness.motion.predictive.state import ADVANCES, BOX_TESTS, LABEL, NARROW_TESTS, VX, World
from harness.motion.predictive.state import STALLED as STALLED_EVENTS
from harness.motion.predictive.windows import (
    APART,
    DUE,
    NEAR,
    OTHER,
    PARTING,
    PHASE,
    TOUCHING,
    UNSURE,
    Windows,
    remove,
)
from harness.narrowphase.advancement import time_of_impact, time_of_wall_impact
from harness.narrowphase.contact_end import end_of_hull_contact, end_of_mesh_contact
from harness.narrowphase.mesh_advancement import HULL_TOLERANCE, MeshWarmStart, time_of_mesh_impact
from harness.narrowphase.tree_pairs import NodePair
from harness.narrowphase.verdicts import SearchVerdict


@kernel
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
    hull, phase, seeds = body.shape.hull, windows.marks[w, PHASE], windows.seeds
    hull_seeds = seeds[w, 0], seeds[w, 1], seeds[w, 2], seeds[w, 3]
    coarse = body.concave and phase == APART
    if phase == TOUCHING:
        if body.concave:
            ended = end_of_mesh_contact(body.shape, body.shape, a, b, 0.0, left, 2.0 * tolerance)
        else:
            ended = end_of_hull_contact(hull, hull, a, b, 0.0, left, 2.0 * tolerance)
        verdict, time, steps = ended.verdict, ended.time, ended.steps
    elif coarse or not body.concave:
        enough = max(tolerance, HULL_TOLERANCE * (a.size + b.size)) if coarse else tolerance
        found = time_of_impact(hull, hull, a, b, 0.0, left, enough, hull_seeds)
        verdict, time, hull_seeds, steps = found.verdict, found.time, found.warm_start, found.steps
    else:
        start = MeshWarmStart(hull_seeds, NodePair(seeds[w, 4], seeds[w, 5]))
        mesh_found = time_of_mesh_impact(body.shape, body.shape, a, b, 0.0, left, tolerance, start)
        verdict, time, steps = mesh_found.verdict, mesh_found.time, mesh_found.steps
        hull_seeds, (seeds[w, 4], seeds[w, 5]) = mesh_found.warm_start
    seeds[w, 0], seeds[w, 1], seeds[w, 2], seeds[w, 3] = hull_seeds
    counts[NARROW_TESTS] += 1
    counts[ADVANCES] += steps
    if verdict == SearchVerdict.NEVER:
        remove(windows, k, w)
        return
    windows.times[w] = now + time
    # What has just parted cannot touch but by rounding
    if verdict == SearchVerdict.STALLED or (phase == PARTING and time == 0.0):
        if time < world.rules.pause:
            windows.times[w] = now + world.rules.pause
            counts[STALLED_EVENTS] += 1
    elif coarse:
        windows.marks[w, PHASE] = NEAR
    elif phase == TOUCHING:
        windows.marks[w, PHASE] = PARTING
    else:
        windows.marks[w, PHASE] = TOUCHING if phase == UNSURE and time == 0.0 else DUE


@kernel
def search_wall(world: World, body: Solids, windows: Windows, k: int, axis: int, now: float) -> None:
    """Find the hit of body k on the wall ahead along an axis."""
    counts, rules = world.tally.counts, world.rules
    face = 2 * axis + (1 if world.spheres.rows[k, VX + axis] > 0.0 else 0)
    flight = motion_of(body, world.spheres.rows, k, now)
    found = time_of_wall_impact(
        body.shape.hull, flight, face, body.scale * rules.half_box[axis], 0.0, 1e300, body.tolerance * flight.size
    )
    counts[BOX_TESTS] += 1
    counts[ADVANCES] += found.steps
    windows.wall_times[k, axis] = now + found.time
    if found.verdict == SearchVerdict.FOUND:
        windows.wall_phases[k, axis] = DUE
    elif found.time < rules.pause:
        windows.wall_times[k, axis] = now + rules.pause
        counts[STALLED_EVENTS] += 1
