"""Times of impact of two bodies for many motions, one after another in one kernel; each as if it were the only one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.kernel import kernel, strict_step
from harness.narrowphase.advancement import time_of_impact
from harness.narrowphase.free_flight import Motion, place, seen_at
from harness.narrowphase.gjk import COLD_START
from harness.narrowphase.mesh_advancement import MESH_COLD_START, MeshShape, time_of_mesh_impact
from harness.narrowphase.pose_gaps import Poses, position
from harness.narrowphase.spheres import passage
from harness.narrowphase.support import SupportMap
from harness.narrowphase.vectors import minus
from harness.narrowphase.verdicts import SearchVerdict

# Searches that are taken up again where they were given up.
MOST_RESUMED = 50


class Motions(NamedTuple):
    """How a body moves, from one start after the other.

    Attributes
    ----------
    start : Poses, at time 0
    velocities : (n, 3) float array, m/s
    spins : (n, 3) float array, rad/s, in the world
    reach : m, the farthest that a point of the body is from its centre
    """

    start: Poses
    velocities: Floats
    spins: Floats
    reach: float


class Window(NamedTuple):
    """What is asked.

    Attributes
    ----------
    until : s, when the search ends
    tolerance : m, the gap at which bodies count as touching
    """

    until: float
    tolerance: float


class OnsetTime(NamedTuple):
    """When two hulls touch: verdict and time as of an `Impact`."""

    verdict: SearchVerdict
    time: float


@kernel
def sphere_impacts(a: Motions, b: Motions, window: Window, times: Floats) -> None:
    """When two spheres touch, s, written; inf if not until the end of the window."""
    for k in range(len(times)):
        gap = minus(position(b.start, k), position(a.start, k))
        velocity = minus(motion_at(b, k).velocity, motion_at(a, k).velocity)
        met = passage(gap, velocity, 0.5 * (a.start.size + b.start.size))
        enter = max(met.enter, 0.0)
        times[k] = enter if enter <= window.until and met.leave >= 0.0 else np.inf


@kernel
def hull_impacts(hull_a: SupportMap, hull_b: SupportMap, a: Motions, b: Motions, window: Window, times: Floats) -> None:
    """As `sphere_impacts`, for hulls; nan where the search was given up."""
    for k in range(len(times)):
        begin = 0.0
        for _ in range(MOST_RESUMED):
            one, other, end = motion_at(a, k), motion_at(b, k), window.until
            found = near_impact(hull_a, hull_b, one, other, begin, end, window.tolerance)
            times[k] = answer(found.verdict, found.time)
            if found.verdict != SearchVerdict.STALLED or not found.time > begin:
                break
            begin = found.time


@kernel
def mesh_impacts(shape_a: MeshShape, shape_b: MeshShape, a: Motions, b: Motions, window: Window, times: Floats) -> None:
    """As `hull_impacts`, for surfaces."""
    for k in range(len(times)):
        begin = 0.0
        for _ in range(MOST_RESUMED):
            one, other, end = motion_at(a, k), motion_at(b, k), window.until
            found = time_of_mesh_impact(shape_a, shape_b, one, other, begin, end, window.tolerance, MESH_COLD_START)
            times[k] = answer(found.verdict, found.time)
            if found.verdict != SearchVerdict.STALLED or not found.time > begin:
                break
            begin = found.time


@kernel
def near_impact(
    hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> OnsetTime:
    """When two hulls come within a tolerance; no digit of the time is lost while the spheres around them are apart."""
    gap, velocity = minus(place(b, begin), place(a, begin)), minus(b.velocity, a.velocity)
    spheres = passage(gap, velocity, a.reach + b.reach + tolerance)
    entry = max(spheres.enter, 0.0)
    rest = min(spheres.leave, end - begin) - entry
    if not rest >= 0.0:
        return OnsetTime(SearchVerdict.NEVER, end)
    one, other = seen_at(a, b, begin + entry)
    found = time_of_impact(hull_a, hull_b, one, other, 0.0, rest, tolerance, COLD_START)
    return OnsetTime(found.verdict, min(end, begin + (entry + found.time)))


@strict_step
def answer(verdict: SearchVerdict, time: float) -> float:
    """The time of an impact, inf for none, nan where neither is known."""
    return time if verdict == SearchVerdict.FOUND else (np.inf if verdict == SearchVerdict.NEVER else np.nan)


@strict_step
def motion_at(body: Motions, k: int) -> Motion:
    """The k-th motion of a body."""
    q, v, w, size = body.start.quaternions, body.velocities, body.spins, body.start.size
    return Motion(
        position(body.start, k),
        (v[k, 0], v[k, 1], v[k, 2]),
        (q[k, 0], q[k, 1], q[k, 2], q[k, 3]),
        (w[k, 0], w[k, 1], w[k, 2]),
        size,
        body.reach,
    )
