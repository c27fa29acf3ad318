"""Memory for a run, as the event loop needs it."""

from __future__ import annotations

import numpy as np

from harness.arrays import Pairs
from harness.motion.predictive.codes import Event, NeighbourSearch
from harness.motion.predictive.grids import empty_grids, size_classes
from harness.motion.predictive.ignored import ignored_by_label
from harness.motion.predictive.initial import InitialState
from harness.motion.predictive.memory import aligned, filled
from harness.motion.predictive.order import along_curve
from harness.motion.predictive.rosters import FEW
from harness.motion.predictive.state import (
    CANDIDATES,
    CLOCK,
    CONTACT,
    COUNTS,
    EVENT,
    EVENT_STATE,
    MOTION,
    NOBODY,
    ONSET,
    ROSTER,
    SCHEDULE,
    SUM,
    SUMS,
    EventQueue,
    Lists,
    Records,
    Rules,
    Scratch,
    Spheres,
    Totals,
    World,
)

# Recorded events handed over at a time.
LOG_SIZE = 1 << 16


def prepare(start: InitialState, rules: Rules, ignored: Pairs, record: bool, states: bool) -> World:
    """A world at time zero: no sphere stands in a cell yet, and all events are unscheduled.

    Parameters
    ----------
    start : InitialState
    rules : Rules
    ignored : (m, 2) int array, pairs i < j that are never asked about, each once
    record : whether events are kept
    states : whether the states of their spheres are kept with them
    """
    n = len(start)
    order = along_curve(start.positions, start.half_box)
    motions = aligned(n, MOTION)
    motions["position"] = start.positions[order]
    motions["velocity"] = start.velocities[order]
    motions["radius"] = start.radii[order]
    schedule = aligned(n, SCHEDULE)
    schedule["pair_time"] = np.inf
    schedule["last_hit"] = -np.inf
    schedule["mass"] = start.masses[order]
    schedule["partner"] = NOBODY
    schedule["kind"] = Event.UNSCHEDULED
    schedule["label"] = order
    schedule["size_class"] = size_classes(start.radii, start.half_box)[order]
    cells = empty_grids(start.half_box, motions["radius"], rules.skin)
    return World(
        spheres=Spheres(motions, schedule, contacts=no_contacts(n)),
        queue=unscheduled(n),
        cells=cells,
        lists=empty_lists(motions, rules.neighbours, len(cells.heads)),
        ignored=ignored_by_label(n, ignored),
        rules=rules,
        totals=no_totals(),
        log=np.zeros(LOG_SIZE if record else 0, dtype=EVENT),
        states=np.zeros(LOG_SIZE if record and states else 0, dtype=EVENT_STATE),
        scratch=Scratch(found=np.zeros(n + 2 + FEW, dtype=np.uint32), lanes=aligned(1, CANDIDATES)),
    )


def unscheduled(n: int) -> EventQueue:
    """All events of n spheres unscheduled."""
    leaves = 1 << max(n - 1, 1).bit_length()
    times = filled(2 * leaves, np.inf, np.float64)
    times[leaves : leaves + n] = 0.0
    winners = aligned(2 * leaves, np.int32)
    winners[leaves : leaves + n] = np.arange(n)
    return EventQueue(times=times, time_bits=times.view(np.int64), winners=winners)


def empty_lists(motions: Records, neighbours: int, cells: int) -> Lists:
    """Neighbour lists with nobody in them, anchored where the spheres are; none at all for another search."""
    listed = neighbours == NeighbourSearch.LISTS
    n = len(motions) if listed else 0
    anchors = aligned(4 * n, np.float64).reshape(n, 4)
    anchors[:, :3], anchors[:, 3] = motions["position"][:n], motions["radius"][:n]
    return Lists(anchors=anchors, members=aligned(n, ROSTER), cells=aligned(cells if listed else 0, ROSTER))


def no_contacts(n: int) -> Records:
    """n spheres that have not hit anything."""
    contacts = np.zeros(n, CONTACT)
    contacts["last"] = -np.inf
    return contacts


def no_totals() -> Totals:
    """Nothing has happened, at time zero."""
    onset = np.zeros(1, dtype=ONSET)
    onset["time"] = -np.inf
    return Totals(
        counts=np.zeros(1, dtype=COUNTS),
        sums=np.zeros(1, dtype=SUMS),
        wall_impulses=np.zeros(6, dtype=SUM),
        clock=np.zeros(1, dtype=CLOCK),
        onset=onset,
    )
