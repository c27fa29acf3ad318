"""Fetch what the events after the next will need, while the next one is worked on.

From some 4000 spheres on, most of an event is waiting for memory: its sphere, the partner, the cells around. The tree
shows who is due soon; asking early costs a few instructions.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.cells import cell_number
from harness.motion.predictive.memory import fetch
from harness.motion.predictive.state import CROSSING, GRID, KIND, LISTS, PARTNER, PLACE, World

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
    """Ask for the rows of sphere k's neighbours; a crossing needs few of them."""
    rows, marks, cells, members = world.spheres.rows, world.spheres.marks, world.cells, world.lists.members
    if world.rules.method == LISTS:
        for m in range(1, min(members[k, 0], 15) + 1):
            fetch(rows, members[k, m])
    elif marks[k, KIND] < CROSSING:
        shapes = cells.shapes
        grid = marks[k, GRID]
        ix, iy, iz = marks[k, PLACE], marks[k, PLACE + 1], marks[k, PLACE + 2]
        for x in range(max(ix - 1, 0), min(ix + 1, shapes[grid, 0] - 1) + 1):
            for y in range(max(iy - 1, 0), min(iy + 1, shapes[grid, 1] - 1) + 1):
                for z in range(max(iz - 1, 0), min(iz + 1, shapes[grid, 2] - 1) + 1):
                    p = cells.heads[cell_number(cells, grid, x, y, z)]
                    fetch(rows, p)
                    fetch(cells.following, p)


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
        shapes = cells.shapes
        grid = marks[k, GRID]
        ix, iy, iz = marks[k, PLACE], marks[k, PLACE + 1], marks[k, PLACE + 2]
        for x in range(max(ix - 1, 0), min(ix + 1, shapes[grid, 0] - 1) + 1):
            for y in range(max(iy - 1, 0), min(iy + 1, shapes[grid, 1] - 1) + 1):
                fetch(cells.heads, cell_number(cells, grid, x, y, iz))
