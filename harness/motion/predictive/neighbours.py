"""Neighbour lists: who can touch whom before either has moved half the skin from its anchor.

Best in a dense fluid, where a sphere collides many times before it leaves its cage. The cells hold the spheres by their
anchors. Leaving the neighbourhood of its anchor is an event: the sphere's list is renewed, and those of its neighbours
are corrected.
"""

from __future__ import annotations

import numpy as np

from harness.kernel import step
from harness.motion.predictive.cells import AROUND, block, gather_wide, insert_by_position, remove
from harness.motion.predictive.ignored import without_ignored
from harness.motion.predictive.state import CAPACITY, Lists, Record, World
from harness.prefetch import prefetch

# The column of an anchor that holds the radius.
RADIUS = 3
# How many candidates ahead anchors are read into the cache.
PREFETCHED = 8


@step
def renew(world: World, k: int) -> bool:
    """Anchor sphere k where it is at the present and list its neighbours. Returns False if a list is full."""
    spheres, cells, lists, found = world.spheres, world.cells, world.lists, world.scratch.found
    members = lists.members
    own, place = members[k], spheres.schedule[k]
    for m in range(own.count):
        prefetch(members, own.who[min(m + PREFETCHED, own.count - 1)])
        remove_neighbour(members[own.who[m]], k)
    for axis in range(3):
        lists.anchors[k, axis] = spheres.motions[k].position[axis]
    remove(cells, spheres.schedule, k)
    insert_by_position(cells, spheres, k)
    around = block(cells.grids[0], place.cell[0], place.cell[1], place.cell[2], AROUND)
    count = without_ignored(world, k, found, gather_wide(cells, cells.grids[0], around, found))
    degree = 0
    for m in range(count):  # who is near is at random: keeping each without asking spares the mispredicted branch
        p = found[np.uintp(m)]
        prefetch(lists.anchors, found[np.uintp(min(m + PREFETCHED, count - 1))])
        found[np.uintp(degree)] = p
        degree += (p != k) & near(lists, k, p, world.rules.skin)
    own.count = min(degree, CAPACITY)
    for m in range(own.count):
        p = found[np.uintp(m)]
        prefetch(members, found[np.uintp(min(m + PREFETCHED, own.count - 1))])
        theirs = members[p]
        if theirs.count == CAPACITY:
            own.count = m
            return False
        own.who[m] = p
        theirs.who[theirs.count] = k
        theirs.count += 1
    return degree <= CAPACITY


@step
def near(lists: Lists, k: int, p: int, skin: float) -> bool:
    """Whether two anchors are within the radii and the skin."""
    anchors = lists.anchors
    x, y, z = anchors[p, 0] - anchors[k, 0], anchors[p, 1] - anchors[k, 1], anchors[p, 2] - anchors[k, 2]
    reach = anchors[k, RADIUS] + anchors[p, RADIUS] + skin
    return bool(x * x + y * y + z * z < reach * reach)


@step
def remove_neighbour(neighbours: Record, k: int) -> None:
    """Take sphere k off a list."""
    last = neighbours.count - 1
    for m in range(last):
        if neighbours.who[m] == k:
            neighbours.who[m] = neighbours.who[last]
            break
    neighbours.count = last
