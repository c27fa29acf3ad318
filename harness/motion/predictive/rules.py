"""What stays the same during a run, chosen to suit the spheres."""

from __future__ import annotations

import numpy as np

from harness.motion.predictive.codes import NeighbourSearch, ResponseCode
from harness.motion.predictive.grids import ratio_classes
from harness.motion.predictive.initial import InitialState
from harness.motion.predictive.order import REORDERED_FROM
from harness.motion.predictive.state import Rules

RESPONSES = {code.name.lower(): code for code in ResponseCode}
SEARCHES = {code.name.lower(): code for code in NeighbourSearch}

# Neighbour lists are faster than cells from this packing on, for at least this many spheres.
LISTS_PACKING = 0.40
LISTS_COUNT = 64
# Skin of the lists, in mean diameters.
SKIN = 0.65
# From this many spheres on, all that the next events need is prefetched, not the records of their spheres alone: 1.4
# times the rate at 10^5, but .8 times while the cells are in the cache; and from the last number on the event queue and
# the neighbours of partners too: once more 1.1 to 1.4 times.
PREFETCH_COUNT = {NeighbourSearch.CELLS: 25_000, NeighbourSearch.LISTS: 4_000}
DEEP_PREFETCH_COUNT = 30_000
# Inelastic bodies can collapse: they hit each other without end in a finite time, three on a line for restitutions
# below 7 - 4 sqrt 3 = .072 (McNamara & Young 1992). Three models are in use. `none` lets it happen, and never gets past
# that time. A cutoff speed makes all slower hits elastic, a collapse or not. `TC` makes hits elastic that come within a
# contact time of the last one (Luding & McNamara 1998). Here it is TC, but only from a row of `LASTING` such hits on:
# hits at one moment, as in a Newton's cradle, lose what they must, and what a collapse has left to lose by then is
# below 1e-9 of the speeds that it began with.
# The contact time, in the time a mean sphere flies its radius. Hits this close also make one collision burst.
CONTACT_TIME = 1e-6
LASTING = 32
# What a stalled sphere waits, in the same unit, and how many hits a burst may have. Elastic bursts come to an end and
# may be long; but in a crystal without room each sphere would take that many hits, so they are shared among all.
COOLDOWN = 1e-3
BURST_LIMIT = {ResponseCode.NONE: 1000, ResponseCode.REFLECT: 1000, ResponseCode.ELASTIC: 1_000_000}
LEAST_BURST_LIMIT = 100
# Events from one re-basing of time to the next, for each sphere and for each run; with response none all spheres must
# predict anew then.
EVENTS_PER_BASE, EVENTS_PER_BASE_NONE, LEAST_EVENTS_PER_BASE = 16, 64, 64
# Re-basings from one re-ordering of memory to the next.
BASES_PER_ORDER = 8
# Gaps below this fraction of the box are rounding.
TOUCHING = 1e-15


def choose_search(start: InitialState, response: str) -> str:
    """'lists' for many spheres of one size class, densely packed, else 'cells'."""
    one_size = int(ratio_classes(start.radii).max(initial=0)) == 0
    dense = len(start) >= LISTS_COUNT and start.packing >= LISTS_PACKING
    return "lists" if dense and one_size and response != "none" else "cells"


def make_rules(start: InitialState, response: str, restitution: float, search: str) -> Rules:
    """The rules of a run.

    Parameters
    ----------
    start : InitialState
    response, search : keys of `RESPONSES` and `SEARCHES`
    restitution : of elastic pair hits
    """
    n = len(start)
    answer, neighbours = RESPONSES[response], SEARCHES[search]
    mean = float(start.radii.mean()) if n else 1.0
    speed = float(np.sqrt((start.velocities**2).sum(axis=1).mean())) if n else 0.0
    radius_time = mean / speed if speed > 0.0 else 1.0
    events_per_base = EVENTS_PER_BASE_NONE if answer == ResponseCode.NONE else EVENTS_PER_BASE
    return Rules(
        half_box=start.half_box,
        neighbours=neighbours.value,
        response=answer.value,
        restitution=restitution,
        skin=2.0 * SKIN * mean if neighbours == NeighbourSearch.LISTS else 0.0,
        contact_time=CONTACT_TIME * radius_time,
        lasting=LASTING,
        burst_window=CONTACT_TIME * radius_time if answer == ResponseCode.REFLECT else 0.0,
        cooldown=COOLDOWN * radius_time,
        burst_limit=burst_limit(answer, n),
        touching=TOUCHING * float(start.half_box.max()),
        events_per_base=LEAST_EVENTS_PER_BASE + events_per_base * n,
        bases_per_order=BASES_PER_ORDER if n >= REORDERED_FROM else 0,
        prefetching=n >= PREFETCH_COUNT[neighbours],
        depth=max(n - 1, 1).bit_length(),
    )


def burst_limit(response: ResponseCode, n: int) -> int:
    """Hits of one burst that each of n spheres may have."""
    limit = BURST_LIMIT[response]
    return max(limit // max(n, 1), LEAST_BURST_LIMIT) if response == ResponseCode.ELASTIC else limit
