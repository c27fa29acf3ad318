"""Fetch what the events after the next will need, while the next one is worked on.

From some 4000 spheres on, most of an event is waiting for memory: its sphere, the partner, the cells around. The tree
shows who is due soon; asking early costs a few instructions.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.cells import ALL, block, cell_number
from harness.motion.predictive.memory import fetch
from harness.motion.predictive.state import CROSSING, GRID, KIND, LISTS, PARTNER, PLACE, RENEWAL, Cells, Ints, World

# Levels of the tree at which a winner's row, its surroundings, and its neighbours' rows are asked for.
SPHERE_LEVEL, AROUND_LEVEL, NEIGHBOURS_LEVEL = 6, 5, 4


@step
def look_ahead(world: World, k: int) -> None:
    """After sphere k's matches: ask for what the winners on its way up need, the more the sooner they are due.

    The winner at a node of level m is due within the next 2^m events or so.
    """
    agenda, spheres = world.agenda, world.spheres
    leaf = agenda.order.size // 2 + k
    soon = int(agenda.winners[leaf >> max(world.rules.depth - SPHERE_LEVEL, 0)])
    fetch(spheres.rows, soon)
    fetch(spheres.book, soon)
    fetch_around(world, int(agenda.winners[leaf >> max(world.rules.depth - AROUND_LEVEL, 0)]))
    fetch_neighbours(world, int(agenda.winners[leaf >> max(world.rules.depth - NEIGHBOURS_LEVEL, 0)]))


@step
def fetch_neighbours(world: World, k: int) -> None:
    """Ask for the rows of sphere k's neighbours."""
    rows, marks, cells, members = world.spheres.rows, world.spheres.marks, world.cells, world.lists.members
    if world.rules.method == LISTS:
        for m in range(1, min(members[k, 0], 15) + 1):
            fetch(rows, members[k, m])
    else:
        from_x, to_x, from_y, to_y, from_z, to_z = cells_ahead(cells, marks, k)
        for x in range(from_x, to_x + 1):
            for y in range(from_y, to_y + 1):
                for z in range(from_z, to_z + 1):
                    p = cells.heads[cell_number(cells, marks[k, GRID], x, y, z)]
                    fetch(rows, p)
                    fetch(cells.following, p)


@step
def cells_ahead(cells: Cells, marks: Ints, k: int) -> tuple[int, int, int, int, int, int]:
    """The cells that sphere k will look at: the layer beyond the next one if it is to cross, else all around."""
    kind = int(marks[k, KIND])
    ix, iy, iz = int(marks[k, PLACE]), int(marks[k, PLACE + 1]), int(marks[k, PLACE + 2])
    axis = ALL
    step = 0
    if kind >= CROSSING and kind < RENEWAL:
        axis = (kind - CROSSING) // 2
        step = 2 * ((kind - CROSSING) % 2) - 1
        ix += step if axis == 0 else 0
        iy += step if axis == 1 else 0
        iz += step if axis == 2 else 0
    return block(cells, marks[k, GRID], ix, iy, iz, axis, step)


@step
def fetch_around(world: World, k: int) -> None:
    """Ask for sphere k's partner, and its cells or list."""
    spheres = world.spheres
    marks = spheres.marks
    partner = int(marks[k, PARTNER])
    if partner >= 0:
        fetch(spheres.rows, partner)
        fetch(spheres.book, partner)
    if world.rules.method == LISTS:
        fetch(world.lists.anchors, k)
        fetch(world.lists.members, k)
        if partner >= 0:
            fetch(world.lists.members, partner)
    else:
        cells = world.cells
        from_x, to_x, from_y, to_y, from_z, _ = cells_ahead(cells, marks, k)
        for x in range(from_x, to_x + 1):
            for y in range(from_y, to_y + 1):
                fetch(cells.heads, cell_number(cells, marks[k, GRID], x, y, from_z))
