"""The narrow search: when the shapes themselves touch, inside the window that their bounding spheres leave."""

from __future__ import annotations

from harness.kernel import kernel
from harness.motion.predictive.codes import Phase
from harness.motion.predictive.solids import SolidWorld, motion_of
from harness.motion.predictive.windows import close
from harness.narrowphase.advancement import time_of_impact, time_of_wall_impact
from harness.narrowphase.body_shapes import shape_of
from harness.narrowphase.contact_end import end_of_hull_contact, end_of_mesh_contact
from harness.narrowphase.free_flight import fastest_passing, speed_of_points
from harness.narrowphase.mesh_advancement import MeshWarmStart, hull_tolerance, time_of_mesh_impact
from harness.narrowphase.tree_pairs import NodePair
from harness.narrowphase.verdicts import SearchVerdict

PASSED_WHILE_WAITING = 0.01
"""Of a size: how far points may pass each other in the time that is waited where a search cannot get on."""


@kernel
def search_pair(solid: SolidWorld, k: int, w: int, now: float) -> None:
    """Find the hit of body k in its window w, which is due; close the window if there is none."""
    world, body = solid.world, solid.body
    motions, schedule, counts = world.spheres.motions, world.spheres.schedule, world.totals.counts[0]
    window, warm = solid.windows.pool[w], solid.windows.warm_starts[w]
    p = int(window.other)
    # The labels order the two, so that it does not matter who holds the window
    swap = schedule[p].label < schedule[k].label
    i = p if swap else k
    j = k if swap else p
    a, b = motion_of(body, motions, i, now), motion_of(body, motions, j, now)
    tolerance = 0.5 * body.tolerance * (a.size + b.size)
    left = max(window.end - now, 0.0)
    one, other, phase = shape_of(body.shapes, i), shape_of(body.shapes, j), window.phase
    hull_start = warm.hulls[0], warm.hulls[1], warm.hulls[2], warm.hulls[3]
    coarse = body.concave and phase == Phase.APART
    if phase == Phase.TOUCHING:
        if body.concave:
            ended = end_of_mesh_contact(one, other, a, b, 0.0, left, 2.0 * tolerance)
        else:
            ended = end_of_hull_contact(one.hull, other.hull, a, b, 0.0, left, 2.0 * tolerance)
        verdict, time, steps = ended.verdict, ended.time, ended.steps
    elif coarse or not body.concave:
        enough = max(tolerance, hull_tolerance(a, b)) if coarse else tolerance
        found = time_of_impact(one.hull, other.hull, a, b, 0.0, left, enough, hull_start)
        verdict, time, hull_start, steps = found.verdict, found.time, found.warm_start, found.steps
    else:
        start = MeshWarmStart(hull_start, NodePair(warm.surfaces[0], warm.surfaces[1]))
        mesh_found = time_of_mesh_impact(one, other, a, b, 0.0, left, tolerance, start)
        verdict, time, steps = mesh_found.verdict, mesh_found.time, mesh_found.steps
        hull_start, (warm.surfaces[0], warm.surfaces[1]) = mesh_found.warm_start
    warm.hulls[0], warm.hulls[1], warm.hulls[2], warm.hulls[3] = hull_start
    counts.narrow_tests += 1
    counts.advancement_steps += steps
    if verdict == SearchVerdict.NEVER:
        close(solid.windows, k, w)
        return
    window.time = now + time
    # What has just parted cannot touch but by rounding
    if verdict == SearchVerdict.STALLED or (phase == Phase.PARTING and time == 0.0):
        wait = longest_wait(world.rules.cooldown, fastest_passing(a, b), 0.5 * (a.size + b.size))
        if time < wait:
            window.time = now + wait
            counts.stalled_events += 1
    elif coarse:
        window.phase = Phase.NEAR
    elif phase == Phase.TOUCHING:
        window.phase = Phase.PARTING
    else:
        window.phase = Phase.TOUCHING if phase == Phase.UNSURE and time == 0.0 else Phase.DUE


@kernel
def longest_wait(cooldown: float, speed: float, size: float) -> float:
    """How long a search that cannot get on may wait: points must not pass unseen, and fast ones pass in no time.

    Parameters
    ----------
    cooldown : s, that a mean sphere waits
    speed : at most that of one point against another
    size : of a body, in the same unit of length
    """
    return min(cooldown, PASSED_WHILE_WAITING * size / speed) if speed > 0.0 else cooldown


@kernel
def search_wall(solid: SolidWorld, k: int, axis: int, now: float) -> None:
    """Find the hit of body k on the wall ahead along an axis."""
    world, body = solid.world, solid.body
    counts, rules, window = world.totals.counts[0], world.rules, solid.windows.walls[k, axis]
    face = 2 * axis + (1 if world.spheres.motions[k].velocity[axis] > 0.0 else 0)
    flight = motion_of(body, world.spheres.motions, k, now)
    found = time_of_wall_impact(
        shape_of(body.shapes, k).hull,
        flight,
        face,
        body.scale * rules.half_box[axis],
        0.0,
        1e300,
        body.tolerance * flight.size,
    )
    counts.box_tests += 1
    counts.advancement_steps += found.steps
    window.time = now + found.time
    if found.verdict == SearchVerdict.FOUND:
        window.phase = Phase.DUE
        return
    wait = longest_wait(rules.cooldown, speed_of_points(flight), flight.size)
    if found.time < wait:
        window.time = now + wait
        counts.stalled_events += 1
