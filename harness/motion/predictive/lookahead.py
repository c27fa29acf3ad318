"""Prefetching: what the events after the next will need is read into the cache while the next one is worked on.

From some 4000 spheres on, most of an event is waiting for memory: its sphere, the partner, the cells around. The tree
shows who is due soon; asking early costs a few instructions. The records of that sphere itself are worth asking for
however few there are: 1.3 times the rate at 10^4, 1.03 times at 10^3.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.cells import AROUND, Block, block, cell_number, layer_beyond
from harness.motion.predictive.codes import Event, NeighbourSearch
from harness.motion.predictive.state import EventQueue, Record, World
from harness.prefetch import prefetch

# Levels of the tree at which a winner's records, its cells or list, and its neighbours' motions are prefetched, and the
# one for its records where they are all.
SPHERE_LEVEL, AROUND_LEVEL, NEIGHBOURS_LEVEL = 6, 5, 4
ALONE_LEVEL = 4
# Levels from a leaf on of which the nodes are prefetched.
PATH_LEVELS = 9
# Neighbours in the first cache line of a list.
IN_A_LINE = 15


@step
def prefetch_next(world: World, k: int) -> None:
    """After an update from sphere k's leaf: prefetch the records of a winner on its way up."""
    queue, spheres = world.queue, world.spheres
    leaf = queue.time_bits.size // 2 + k
    soon = int(queue.winners[leaf >> max(world.rules.depth - ALONE_LEVEL, 0)])
    prefetch(spheres.motions, soon)
    prefetch(spheres.schedule, soon)


@step
def prefetch_ahead(world: World, k: int, deep: bool) -> None:
    """After an update from sphere k's leaf: prefetch for the winners on its way up, the more the sooner they are due.

    The winner at a node of level m is due within the next 2^m events or so.
    """
    queue, spheres = world.queue, world.spheres
    leaf = queue.time_bits.size // 2 + k
    soon = int(queue.winners[leaf >> max(world.rules.depth - SPHERE_LEVEL, 0)])
    prefetch(spheres.motions, soon)
    prefetch(spheres.schedule, soon)
    if deep:
        prefetch_path(queue, queue.time_bits.size // 2 + soon)
    prefetch_candidates(world, int(queue.winners[leaf >> max(world.rules.depth - AROUND_LEVEL, 0)]))
    prefetch_neighbours(world, int(queue.winners[leaf >> max(world.rules.depth - NEIGHBOURS_LEVEL, 0)]), deep)


@step
def prefetch_path(queue: EventQueue, leaf: int) -> None:
    """Prefetch the way of an update from a leaf through the lowest nodes of the tree.

    These were most of an update at 10^5 spheres; the nodes above are passed so often that they stay in the cache.
    """
    node = leaf
    for _ in range(PATH_LEVELS):
        prefetch(queue.time_bits, node)
        prefetch(queue.winners, node)
        node = node >> 1


@step
def prefetch_neighbours(world: World, k: int, deep: bool) -> None:
    """Prefetch the motions of sphere k's neighbours."""
    motions, cells = world.spheres.motions, world.cells
    if world.rules.neighbours == NeighbourSearch.LISTS:
        prefetch_members(world, k)
        partner = int(world.spheres.schedule[k].partner)
        if deep and partner >= 0:
            prefetch_members(world, partner)
    else:
        grid = cells.grids[world.spheres.schedule[k].size_class]
        near = cells_ahead(grid, world.spheres.schedule[k])
        for x in range(near.from_x, near.to_x + 1):
            for y in range(near.from_y, near.to_y + 1):
                for z in range(near.from_z, near.to_z + 1):
                    p = cells.heads[cell_number(grid, x, y, z)]
                    prefetch(motions, p)
                    prefetch(cells.following, p)


@step
def prefetch_members(world: World, k: int) -> None:
    """Prefetch the motions of those in the first line of sphere k's list."""
    members = world.lists.members[k]
    for m in range(min(members.count, IN_A_LINE)):
        prefetch(world.spheres.motions, members.who[m])


@step
def cells_ahead(grid: Record, sphere: Record) -> Block:
    """The cells that a sphere will search: the layer beyond the next one if it is to cross, else all around."""
    ix, iy, iz = int(sphere.cell[0]), int(sphere.cell[1]), int(sphere.cell[2])
    layer = AROUND
    if sphere.kind == Event.CROSSING:
        layer = layer_beyond(sphere.face)
        ix += layer.step if layer.axis == 0 else 0
        iy += layer.step if layer.axis == 1 else 0
        iz += layer.step if layer.axis == 2 else 0
    return block(grid, ix, iy, iz, layer)


@step
def prefetch_candidates(world: World, k: int) -> None:
    """Prefetch the records of sphere k's partner, and its own cells or list."""
    spheres, cells, lists = world.spheres, world.cells, world.lists
    partner = int(spheres.schedule[k].partner)
    if partner >= 0:
        prefetch(spheres.motions, partner)
        prefetch(spheres.schedule, partner)
    if world.rules.neighbours == NeighbourSearch.LISTS:
        prefetch(lists.anchors, k)
        prefetch(lists.members, k)
        if partner >= 0:
            prefetch(lists.anchors, partner)
            prefetch(lists.members, partner)
    else:
        grid = cells.grids[spheres.schedule[k].size_class]
        ahead = cells_ahead(grid, spheres.schedule[k])
        for x in range(ahead.from_x, ahead.to_x + 1):
            for y in range(ahead.from_y, ahead.to_y + 1):
                prefetch(cells.heads, cell_number(grid, x, y, ahead.from_z))
