"""Until when two bodies that touch go on touching: conservative advancement, the other way round.

Bodies that stay in touch when any of their points is displaced by less than some depth do so for that depth over the
speed at which their points can approach or leave each other. Hulls are that deep in each other if they still overlap
when both are shrunk by it; surfaces, if an edge of one goes that far through a triangle of the other.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from harness.kernel import kernel
from harness.narrowphase.advancement import IMPACT, MOST_STEPS, NEVER, STALLED, Impact, Motion, orientation, place
from harness.narrowphase.gjk import MARGIN, NO_SEEDS, OVERLAP, Seeds, hull_distance, relative_pose
from harness.narrowphase.support import SupportMap
from harness.narrowphase.vectors import dot, minus, scaled

# How much both hulls are shrunk at most.
MOST_SHRUNK = 0.9


@kernel
def time_of_parting(
    hull: SupportMap, inradius: float, a: Motion, b: Motion, begin: float, end: float, tolerance: float, seeds: Seeds
) -> Impact:
    """When two bodies of one hull that touch at the beginning are farther than a tolerance apart.

    Parameters
    ----------
    hull : SupportMap
    inradius : of a sphere around the centre that the hull of size 1 holds
    a, b, begin, end, seeds : as for `time_of_impact`
    tolerance : m; gaps below are contact. Above 0, since partings into a smaller gap cannot be told

    Returns
    -------
    Impact
        With the verdict IMPACT at a time at which they are apart, and before which they always touch.
    """
    margin = MARGIN * (a.size + b.size)
    least = max(tolerance, 2.0 * margin)
    speed = leaving(a, b)
    time, shrunk = begin, 0.5
    for step in range(1, MOST_STEPS + 1):
        turn_a, turn_b = orientation(a, time), orientation(b, time)
        offset = minus(place(b, time), place(a, time))
        depth = 0.0
        while depth == 0.0 and shrunk * inradius * (a.size + b.size) > least:
            rest = 1.0 - shrunk
            pose = relative_pose(turn_a, rest * a.size, turn_b, rest * b.size, offset)
            inner = hull_distance(hull, hull, pose, NO_SEEDS, scaled(pose.offset, -1.0), margin, margin)
            if inner.verdict == OVERLAP:
                depth = shrunk * inradius * (a.size + b.size)
            else:
                shrunk *= 0.5
        shrunk = min(2.0 * shrunk, MOST_SHRUNK)
        if depth == 0.0:
            pose = relative_pose(turn_a, a.size, turn_b, b.size, offset)
            found = hull_distance(hull, hull, pose, seeds, scaled(pose.offset, -1.0), margin, np.inf)
            seeds = found.seeds
            if found.upper >= least:
                return Impact(IMPACT, time, found.upper, (0.0, 0.0, 0.0), seeds, step)
            depth = least - found.upper
        time += depth / speed
        if not time < end:
            return Impact(NEVER, end, 0.0, (0.0, 0.0, 0.0), seeds, step)
    return Impact(STALLED, time, 0.0, (0.0, 0.0, 0.0), seeds, MOST_STEPS)


@kernel
def leaving(a: Motion, b: Motion) -> float:
    """How fast a point of one body can move as seen from a point of the other, m/s."""
    velocity = minus(b.velocity, a.velocity)
    return sqrt(dot(velocity, velocity)) + sqrt(dot(a.spin, a.spin)) * a.reach + sqrt(dot(b.spin, b.spin)) * b.reach
