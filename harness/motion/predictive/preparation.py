"""From a caller's arrays to a world ready to fly: checks, choice of search, memory."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from harness.errors import InputError
from harness.motion.predictive.cells import build, size_classes
from harness.motion.predictive.order import CROWD, along_curve
from harness.motion.predictive.state import (
    CANDIDATES,
    CELLS,
    CLOCK,
    COUNTS,
    ELASTIC,
    EVENT,
    FRESH,
    LISTS,
    MOTION,
    NEIGHBOURS,
    NONE,
    ONSET,
    REFLECT,
    SCHEDULE,
    SUM,
    SUMS,
    Agenda,
    Floats,
    Lists,
    Records,
    Rules,
    Scratch,
    Spheres,
    Tally,
    World,
    aligned,
)

RESPONSES = {"none": NONE, "reflect": REFLECT, "elastic": ELASTIC}
SEARCHES = {"cells": CELLS, "lists": LISTS}

# Neighbour lists are faster than cells from this packing on, in crowds of at least this many.
DENSE = 0.40
LEAST = 64
# From this many on, what the next events need is fetched ahead: 1.4 times the rate at 10^5, a loss while all is in
# the cache.
MULTITUDE = {CELLS: 20_000, LISTS: 4_000}
# Skin of the lists, in mean diameters.
SKIN = 0.65
# A pair hit this soon after another, in the time a mean sphere flies its radius, is part of one lasting contact (TC
# model).
CONTACT = 1e-6
# What a stalled sphere waits, in the same unit, and how many hits in no time make it stall. Elastic ones come to an end
# and may be many; but in a crystal without room each sphere would take that many, so they are shared among all.
PAUSE = 1e-3
BURST = {NONE: 1000, REFLECT: 1000, ELASTIC: 1_000_000}
BURST_LEAST = 100
# Events to one re-basing of time, for each sphere and for each run; with response none every sphere must look again
# then.
SPAN, SPAN_NONE, SPAN_LEAST = 16, 64, 64
# Re-basings to one re-ordering of memory.
TIDYING = 8
# Gaps below this fraction of the box are rounding.
TOUCHING = 1e-15
# Recorded events handed over at a time.
CHUNK = 1 << 16


@dataclass(frozen=True)
class Start:
    """Checked arrays of n spheres, SI units."""

    positions: Floats
    velocities: Floats
    radii: Floats
    masses: Floats
    half_box: Floats

    def __len__(self) -> int:
        return len(self.radii)

    @property
    def packing(self) -> float:
        """Volume of the spheres to that of the box."""
        return float((self.radii**3).sum() * np.pi / 6.0 / np.prod(self.half_box))


def check(
    positions: ArrayLike, velocities: ArrayLike, radii: ArrayLike, masses: ArrayLike, half_box: ArrayLike
) -> Start:
    """The arrays in one shape and kind, or an InputError that says what is wrong with them."""
    radii_ = np.array(radii, dtype=np.float64, ndmin=1)
    n = len(radii_)
    start = Start(
        np.array(positions, dtype=np.float64).reshape(-1, 3) if n == 0 else np.array(positions, dtype=np.float64),
        np.array(velocities, dtype=np.float64).reshape(-1, 3) if n == 0 else np.array(velocities, dtype=np.float64),
        radii_,
        np.array(masses, dtype=np.float64, ndmin=1),
        np.array(half_box, dtype=np.float64),
    )
    shapes = {"positions": (n, 3), "velocities": (n, 3), "radii": (n,), "masses": (n,), "half_box": (3,)}
    for name, shape in shapes.items():
        array = getattr(start, name)
        if array.shape != shape:
            raise InputError(f"{name} must have the shape {shape}, not {array.shape}")
        if not np.isfinite(array).all():
            raise InputError(f"{name} must be finite")
    for name in ("radii", "masses", "half_box"):
        if (getattr(start, name) <= 0.0).any():
            raise InputError(f"{name} must be positive")
    return start


def choose_search(start: Start, response: str) -> str:
    """'lists' for a dense crowd of spheres of one size class, else 'cells'."""
    one_size = int(size_classes(start.radii).max(initial=0)) == 0
    dense = len(start) >= LEAST and start.packing >= DENSE
    return "lists" if dense and one_size and response != "none" else "cells"


def prepare(start: Start, response: str, restitution: float, record: bool, search: str) -> World:
    """Memory for a run; no sphere stands in a cell yet, and each one's first look is its next event."""
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
    schedule["partner"] = -1
    schedule["kind"] = FRESH
    schedule["label"] = order
    schedule["size_class"] = size_classes(start.radii)[order]
    answer = RESPONSES[response]
    method = SEARCHES[search]
    mean = float(start.radii.mean()) if n else 1.0
    speed = float(np.sqrt((start.velocities**2).sum(axis=1).mean())) if n else 0.0
    instant = mean / speed if speed > 0.0 else 1.0
    skin = 2.0 * SKIN * mean if method == LISTS else 0.0
    rules = Rules(
        half_box=start.half_box,
        method=method,
        response=answer,
        restitution=restitution,
        skin=skin,
        contact_time=CONTACT * instant,
        blink=CONTACT * instant if answer == REFLECT else 0.0,
        pause=PAUSE * instant,
        burst=max(BURST[answer] // max(n, 1), BURST_LEAST) if answer == ELASTIC else BURST[answer],
        touching=TOUCHING * float(start.half_box.max()),
        span=SPAN_LEAST + (SPAN_NONE if answer == NONE else SPAN) * n,
        crowded=n >= MULTITUDE[method],
        depth=max(n - 1, 1).bit_length(),
        tidying=TIDYING if n >= CROWD else 0,
    )
    return World(
        spheres=Spheres(motions, schedule, contacts=np.full(n, -np.inf)),
        agenda=agenda(n),
        cells=build(start.half_box, start.radii, skin),
        lists=lists(motions, method),
        rules=rules,
        tally=tally(),
        journal=np.zeros(CHUNK if record else 0, dtype=EVENT),
        scratch=Scratch(found=np.zeros(n + 2, dtype=np.uint32), lanes=aligned(1, CANDIDATES)),
    )


def agenda(n: int) -> Agenda:
    """Nobody has looked yet."""
    leaves = 1 << max(n - 1, 1).bit_length()
    times = np.full(2 * leaves, np.inf)
    times[leaves : leaves + n] = 0.0
    winners = np.zeros(2 * leaves, dtype=np.int32)
    winners[leaves : leaves + n] = np.arange(n)
    return Agenda(
        times=times,
        order=times.view(np.int64),
        winners=winners,
    )


def lists(motions: Records, method: int) -> Lists:
    """Empty neighbour lists, anchored where the spheres are, or none at all."""
    n = len(motions) if method == LISTS else 0
    return Lists(anchors=motions["position"][:n].copy(), members=aligned(n, NEIGHBOURS))


def tally() -> Tally:
    """Nothing has happened, at time zero."""
    onset = np.zeros(1, dtype=ONSET)
    onset["time"] = -np.inf
    return Tally(
        counts=np.zeros(1, dtype=COUNTS),
        sums=np.zeros(1, dtype=SUMS),
        walls=np.zeros(6, dtype=SUM),
        clock=np.zeros(1, dtype=CLOCK),
        onset=onset,
    )
