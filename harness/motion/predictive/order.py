"""Spheres that are near each other in the box, near each other in memory.

Along a Morton curve, at the start and again from time to time. With 10^5 spheres the cache misses are most of an
event's time, and this doubles the rate. Only the internal numbering changes; labels keep the caller's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.motion.predictive.state import World

# Fewer spheres than this fit into the cache in any order.
REORDERED_FROM = 2048


def along_curve(positions: Floats, half_box: Floats) -> NDArray[np.intp]:
    """(n,) order of the spheres along a Morton curve of 2^21 steps a side."""
    if len(positions) < REORDERED_FROM:
        return np.arange(len(positions))
    place = np.clip((positions + half_box) / (2.0 * half_box.max()), 0.0, 1.0)
    x, y, z = (spread(axis) for axis in (place * (2**21 - 1)).astype(np.uint64).T)
    return np.argsort(x << np.uint64(2) | y << np.uint64(1) | z, kind="stable")


def spread(bits: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Two zeros between any two of the lowest 21 bits."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        bits = (bits | bits << np.uint64(shift)) & np.uint64(mask)
    return bits


def reorder(world: World) -> None:
    """Put the spheres of a running world in order again; they stand in no cell afterwards."""
    spheres, queue, cells, lists = world.spheres, world.queue, world.cells, world.lists
    count = len(spheres.motions)
    order = along_curve(positions_at(world, float(world.totals.clock["now"][0])), world.rules.half_box)
    moved_to = np.empty(count, dtype=np.int64)
    moved_to[order] = np.arange(count)
    leaves = queue.times[len(queue.times) // 2 :][:count]
    for array in (spheres.motions, spheres.schedule, spheres.contacts, cells.renewals, leaves):
        array[:] = array[order]
    partners = spheres.schedule["partner"]
    partners[:] = np.where(partners >= 0, moved_to[partners], -1)
    if len(lists.members):
        lists.anchors[:] = lists.anchors[order]
        lists.members[:] = lists.members[order]
        lists.cells["count"] = 0
        lists.members["who"] = moved_to[np.minimum(lists.members["who"], count - 1)]
    if len(cells.anchors):
        cells.anchors[:] = cells.anchors[order]
        cells.larger["count"] = 0
    cells.heads[:] = count


def positions_at(world: World, now: float) -> Floats:
    """(n, 3) positions at a time counted from the base, by internal number, m."""
    motions = world.spheres.motions
    moved: Floats = motions["position"] + motions["velocity"] * (now - motions["time"][:, None])
    return moved


def labelled(world: World, values: Floats) -> Floats:
    """Values by internal number, by label instead."""
    out = np.empty_like(values)
    out[world.spheres.schedule["label"]] = values
    return out
