"""When two convex hulls that overlap are apart again: what is in them need not be searched for a touch beyond that."""

from __future__ import annotations

import numpy as np

from harness.kernel import kernel
from harness.narrowphase.free_flight import Motion, fastest_passing, relative_motion
from harness.narrowphase.gjk import MARGIN, WarmStart, hull_distance
from harness.narrowphase.support import SupportMap
from harness.narrowphase.vectors import scaled

# How far points move, of the mean size, until the first time that is tried; that is doubled for each of the next tries.
FIRST_WAY, MOST_TRIALS = 0.05, 7


@kernel
def apart_again(
    hull_a: SupportMap,
    hull_b: SupportMap,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    gap: float,
    start: WarmStart,
) -> float:
    """A time (s) in a window at which two hulls are apart again, or its end if none is found.

    Later and later times are tried: bodies that have just parted are in each other's hollows for a moment, and a search
    through their trees up to when their spheres part takes a fifth more steps.

    Parameters
    ----------
    hull_a, hull_b : of the bodies, in their own axes and units
    a, b : how they move
    begin, end : s, of the window
    gap : m, by more than which they must be apart
    start : WarmStart of the last search on this pair
    """
    speed, margin = fastest_passing(a, b), MARGIN * (a.size + b.size)
    if not speed > 0.0:
        return end
    wait = FIRST_WAY * 0.5 * (a.size + b.size) / speed
    for _ in range(MOST_TRIALS):
        if not begin + wait < end:
            break
        pose = relative_motion(a, b, begin + wait).pose
        found = hull_distance(hull_a, hull_b, pose, start, scaled(pose.offset, -1.0), margin, np.inf, 0.0)
        if found.lower > gap:
            return begin + wait
        start = found.warm_start
        wait *= 2.0
    return end
