"""Neighbour lists: who can touch whom before either has moved half the skin from its anchor.

Best in a dense fluid, where a sphere collides many times before it leaves its cage. Cells hold the spheres by their
anchors. Leaving the neighbourhood of its anchor is an event: the sphere's list is renewed, and those of its neighbours
are corrected.
"""

from __future__ import annotations

import numpy as np

from harness.kernel import step
from harness.motion.predictive.cells import AROUND, block, cell_number, cell_of, index
from harness.motion.predictive.ignored import without_ignored
from harness.motion.predictive.rosters import copy, enlist, strike
from harness.motion.predictive.state import CAPACITY, Lists, World
from harness.prefetch import prefetch

# The column of an anchor that holds the radius.
RADIUS = 3
# How many candidates ahead anchors are read into the cache.
PREFETCHED = 8


@step
def settle(world: World, k: int) -> bool:
    """Put sphere k into the cell of its anchor. Returns False if the cell is full."""
    cells, own = world.cells, world.spheres.schedule[k]
    for axis in range(3):
        own.cell[axis] = index(cells.grids[0], axis, world.lists.anchors[k, axis])
    return enlist(world.lists.cells[cell_of(cells, own)], k)


@step
def renew(world: World, k: int) -> bool:
    """Anchor sphere k where it is at the present and list its neighbours. Returns False if there is no room."""
    spheres, cells, lists, found = world.spheres, world.cells, world.lists, world.scratch.found
    members = lists.members
    own = members[k]
    for m in range(own.count):
        prefetch(members, own.who[min(m + PREFETCHED, own.count - 1)])
        strike(members[own.who[m]], k)
    strike(lists.cells[cell_of(cells, spheres.schedule[k])], k)
    for axis in range(3):
        lists.anchors[k, axis] = spheres.motions[k].position[axis]
    room = settle(world, k)
    count = without_ignored(world, k, found, gather_around_anchor(world, k))
    degree = 0
    for m in range(count):  # who is near is at random: keeping each without asking spares the mispredicted branch
        p = found[np.uintp(m)]
        prefetch(lists.anchors, found[np.uintp(min(m + PREFETCHED, count - 1))])
        found[np.uintp(degree)] = p
        degree += (p != k) & near(lists, k, p, world.rules.skin)
    own.count = 0
    for m in range(min(degree, CAPACITY)):
        p = found[np.uintp(m)]
        prefetch(members, found[np.uintp(min(m + PREFETCHED, degree - 1))])
        if not enlist(members[p], k):
            return False
        enlist(own, p)
    return room and degree <= CAPACITY


@step
def gather_around_anchor(world: World, k: int) -> int:
    """List the spheres that are anchored in the cells around sphere k's. Returns how many they are."""
    grid, place = world.cells.grids[0], world.spheres.schedule[k].cell
    around = block(grid, place[0], place[1], place[2], AROUND)
    n = 0
    for x in range(around.from_x, around.to_x + 1):
        for y in range(around.from_y, around.to_y + 1):
            column = cell_number(grid, x, y, 0)
            for z in range(around.from_z, around.to_z + 1):
                n = copy(world.lists.cells[np.uintp(column + z)], world.scratch.found, n)
    return n


@step
def near(lists: Lists, k: int, p: int, skin: float) -> bool:
    """Whether two anchors are within the radii and the skin."""
    anchors = lists.anchors
    x, y, z = anchors[p, 0] - anchors[k, 0], anchors[p, 1] - anchors[k, 1], anchors[p, 2] - anchors[k, 2]
    reach = anchors[k, RADIUS] + anchors[p, RADIUS] + skin
    return bool(x * x + y * y + z * z < reach * reach)
