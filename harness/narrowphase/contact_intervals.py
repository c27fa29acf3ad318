"""When two bodies that pass through each other touch: all intervals of a window, for hulls and for surfaces.

A contact begins with a time of impact, and from then on it is followed to its end.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.kernel import inner, kernel
from harness.narrowphase.advancement import time_of_impact
from harness.narrowphase.contact_end import ContactEnd, Shape, end_of_hull_contact, end_of_mesh_contact
from harness.narrowphase.free_flight import Motion
from harness.narrowphase.gjk import COLD_START
from harness.narrowphase.mesh_advancement import MESH_COLD_START, MeshShape, time_of_mesh_impact
from harness.narrowphase.support import SupportMap
from harness.narrowphase.tree_pairs import ROOTS, NodePair
from harness.narrowphase.verdicts import SearchVerdict

# Searches for the next contact of surfaces that are taken up again where they were given up.
MOST_RESUMED = 50


class Contacts(NamedTuple):
    """All contacts of a window.

    Attributes
    ----------
    intervals : (k, 2) float array, s, when each begins and ends; ascending, apart, and within the window
    stalled : whether a search was given up at the end of the last one; nothing is known of what is after it
    """

    intervals: Floats
    stalled: bool


class Onset(NamedTuple):
    """When the next contact begins, and between which triangles, if they are surfaces; else as of an `Impact`."""

    verdict: SearchVerdict
    time: float
    leaves: NodePair


@kernel
def hull_contacts(
    hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Contacts:
    """All times in a window at which two hulls touch.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    a, b : Motion
    begin, end : s, the window
    tolerance : m, the gap at which hulls count as touching

    Returns
    -------
    Contacts
        That hold every instant at which the hulls overlap. Where a contact begins, the gap is between a quarter of
        the tolerance and all of it, unless the window begins there; where it ends, it is between 9/8 and 5/4
        of it. Contacts between which the gap is never wider than 9/8 of the tolerance are one, and so may be those
        between which it is no wider than 5/4. Some may be of hulls that only come within the tolerance.
    """
    return contacts(hull_a, hull_b, a, b, begin, end, tolerance, next_hull_contact, end_of_hull_contact)


@kernel
def mesh_contacts(
    shape_a: MeshShape, shape_b: MeshShape, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Contacts:
    """All times in a window at which two surfaces touch; one inside the other does not.

    Parameters and answer as for `hull_contacts`, with `MeshShape` for hulls.
    """
    return contacts(shape_a, shape_b, a, b, begin, end, tolerance, next_mesh_contact, end_of_mesh_contact)


@inner
def contacts(
    shape_a: Shape,
    shape_b: Shape,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    next_contact: Callable[[Shape, Shape, Motion, Motion, float, float, float], Onset],
    end_of_contact: Callable[[Shape, Shape, Motion, Motion, float, float, float], ContactEnd],
) -> Contacts:
    """All contacts of hulls or surfaces, given what finds the next one and what follows it to its end."""
    intervals, count, time = np.empty((4, 2)), 0, begin
    while time < end:
        onset = next_contact(shape_a, shape_b, a, b, time, end, tolerance)
        if onset.verdict != SearchVerdict.FOUND:
            return Contacts(intervals[:count].copy(), onset.verdict == SearchVerdict.STALLED)
        ending = end_of_contact(shape_a, shape_b, a, b, onset.time, end, tolerance)
        intervals = with_capacity(intervals, count)
        intervals[count, 0], intervals[count, 1] = onset.time, ending.time
        count += 1
        if ending.verdict == SearchVerdict.STALLED or not ending.time > time:
            return Contacts(intervals[:count].copy(), True)
        time = ending.time
    return Contacts(intervals[:count].copy(), False)


@inner
def next_hull_contact(
    hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Onset:
    """When two hulls touch, at the beginning of a window or later; parameters as for `hull_contacts`."""
    found = time_of_impact(hull_a, hull_b, a, b, begin, end, tolerance, COLD_START)
    return Onset(found.verdict, found.time, ROOTS)


@inner
def next_mesh_contact(
    shape_a: MeshShape, shape_b: MeshShape, a: Motion, b: Motion, begin: float, end: float, tolerance: float
) -> Onset:
    """When two surfaces touch, at the beginning of a window or later; parameters as for `mesh_contacts`."""
    found = time_of_mesh_impact(shape_a, shape_b, a, b, begin, end, tolerance, MESH_COLD_START)
    for _ in range(MOST_RESUMED):
        # given up where one is inside the other and spins fast; nothing touches before
        if found.verdict != SearchVerdict.STALLED or not found.time > begin:
            break
        begin = found.time
        found = time_of_mesh_impact(shape_a, shape_b, a, b, begin, end, tolerance, MESH_COLD_START)
    leaves = found.warm_start.leaves
    return Onset(found.verdict, found.time, leaves if leaves.a >= 0 else ROOTS)


@kernel
def with_capacity(intervals: Floats, count: int) -> Floats:
    """The same, longer if full."""
    if count < len(intervals):
        return intervals
    longer = np.empty((2 * count, 2))
    for k in range(count):
        longer[k, 0], longer[k, 1] = intervals[k, 0], intervals[k, 1]
    return longer
