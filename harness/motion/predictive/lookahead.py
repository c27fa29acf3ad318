"""Fetch what the events after the next will need, while the next one is worked on.

From some 4000 spheres on, most of an event is waiting for memory: its sphere, the partner, the cells around. The tree
shows who is due soon; asking early costs a few instructions.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.cells import ALL, Block, Layer, block, cell_number
from harness.motion.predictive.memory import fetch
from harness.motion.predictive.state import CROSSING, LISTS, RENEWAL, Record, World

# Levels of the tree at which a winner's records, its surroundings, and its neighbours' motions are asked for.
SPHERE_LEVEL, AROUND_LEVEL, NEIGHBOURS_LEVEL = 6, 5, 4


@step
def look_ahead(world: World, k: int) -> None:
    """After sphere k's matches: ask for what the winners on its way up need, the more the sooner they are due.

    The winner at a node of level m is due within the next 2^m events or so.
    """
    agenda, spheres = world.agenda, world.spheres
    leaf = agenda.order.size // 2 + k
    soon = int(agenda.winners[leaf >> max(world.rules.depth - SPHERE_LEVEL, 0)])
    fetch(spheres.motions, soon)
    fetch(spheres.schedule, soon)
    fetch_around(world, int(agenda.winners[leaf >> max(world.rules.depth - AROUND_LEVEL, 0)]))
    fetch_neighbours(world, int(agenda.winners[leaf >> max(world.rules.depth - NEIGHBOURS_LEVEL, 0)]))


@step
def fetch_neighbours(world: World, k: int) -> None:
    """Ask for the motions of sphere k's neighbours."""
    motions, cells, lists = world.spheres.motions, world.cells, world.lists
    if world.rules.method == LISTS:
        for m in range(min(lists.members[k].count, 15)):
            fetch(motions, lists.members[k].who[m])
    else:
        grid = cells.grids[world.spheres.schedule[k].size_class]
        ahead = cells_ahead(grid, world.spheres.schedule[k])
        for x in range(ahead.from_x, ahead.to_x + 1):
            for y in range(ahead.from_y, ahead.to_y + 1):
                for z in range(ahead.from_z, ahead.to_z + 1):
                    p = cells.heads[cell_number(grid, x, y, z)]
                    fetch(motions, p)
                    fetch(cells.following, p)


@step
def cells_ahead(grid: Record, sphere: Record) -> Block:
    """The cells that a sphere will look at: the layer beyond the next one if it is to cross, else all around."""
    ix, iy, iz = int(sphere.cell[0]), int(sphere.cell[1]), int(sphere.cell[2])
    axis = ALL
    step = 0
    if sphere.kind >= CROSSING and sphere.kind < RENEWAL:
        axis = (sphere.kind - CROSSING) // 2
        step = 2 * ((sphere.kind - CROSSING) % 2) - 1
        ix += step if axis == 0 else 0
        iy += step if axis == 1 else 0
        iz += step if axis == 2 else 0
    return block(grid, ix, iy, iz, Layer(axis, step))


@step
def fetch_around(world: World, k: int) -> None:
    """Ask for sphere k's partner, and its cells or list."""
    spheres, cells, lists = world.spheres, world.cells, world.lists
    partner = int(spheres.schedule[k].partner)
    if partner >= 0:
        fetch(spheres.motions, partner)
        fetch(spheres.schedule, partner)
    if world.rules.method == LISTS:
        fetch(lists.anchors, k)
        fetch(lists.members, k)
        if partner >= 0:
            fetch(lists.members, partner)
    else:
        grid = cells.grids[spheres.schedule[k].size_class]
        ahead = cells_ahead(grid, spheres.schedule[k])
        for x in range(ahead.from_x, ahead.to_x + 1):
            for y in range(ahead.from_y, ahead.to_y + 1):
                fetch(cells.heads, cell_number(grid, x, y, ahead.from_z))
