"""Which larger spheres are near a cell.

A sphere is registered at all the cells of finer grids whose spheres it can touch before it is its margin away from its
anchor, where it was registered. So a small sphere finds the larger ones that it can touch at its own cell, and a large
one finds the smaller ones in the cells where it is registered. A small sphere that comes near from outside crosses into
such a cell, and finds it there. To be a margin away from the anchor is an event.

At a cell with more of them than it has room for, as where spheres overlap, they are searched for in the cells of the
coarser grids.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import step
from harness.motion.predictive.cells import cell_number, distance_to_cell, gather_cell, gather_following, index
from harness.motion.predictive.codes import CellTask
from harness.motion.predictive.exit_times import time_to_leave
from harness.motion.predictive.state import LARGER_CAPACITY, Cells, Record, World


class Ball(NamedTuple):
    """All within `reach` of a point, m."""

    x: float
    y: float
    z: float
    reach: float


@step
def register_all(world: World, placed: bool) -> None:
    """Register all spheres at the cells around their anchors, which are where they are unless they are placed."""
    anchors, motions = world.cells.anchors, world.spheres.motions
    for k in range(anchors.size):
        if not placed:
            for axis in range(3):
                anchors[k].position[axis] = motions[k].position[axis]
        anchors[k].count = 0
        visit_around_anchor(world, k, CellTask.REGISTER, 0)


@step
def register_anew(world: World, k: int, now: float) -> None:
    """Move the anchor of sphere k to where it is at the present."""
    anchor, motion = world.cells.anchors[k], world.spheres.motions[k]
    if anchor.first >= 0:
        visit_registered(world, CellTask.REMOVE, k, 0)
    else:
        visit_around_anchor(world, k, CellTask.REMOVE, 0)
    for axis in range(3):
        anchor.position[axis] = motion.position[axis] + motion.velocity[axis] * (now - motion.time)
    anchor.count = 0
    visit_around_anchor(world, k, CellTask.REGISTER, 0)


@step
def gather_smaller(world: World, k: int, n: int) -> int:
    """Append the smaller spheres that sphere k can touch before it is registered anew, which is scheduled."""
    cells, anchor = world.cells, world.cells.anchors[k]
    margin = cells.grids[world.spheres.schedule[k].size_class].margin
    at = anchor.position
    # A little early, so that rounding cannot make it late
    cells.renewals[k] = time_to_leave(at[0], at[1], at[2], world.spheres.motions[k], 0.998 * margin * margin)
    if anchor.first >= 0:
        return visit_registered(world, CellTask.GATHER, k, n)
    return visit_around_anchor(world, k, CellTask.GATHER, n)


@step
def visit_around_anchor(world: World, k: int, task: int, n: int) -> int:
    """Do something at all cells of finer grids whose spheres sphere k can touch. Returns how many are found now."""
    cells, at = world.cells, world.cells.anchors[k].position
    own = world.spheres.schedule[k].size_class
    for finer in range(own + 1, cells.grids.size):
        reach = world.spheres.motions[k].radius + cells.grids[finer].largest + cells.grids[own].margin
        n = visit_ball(world, cells.grids[finer], Ball(at[0], at[1], at[2], reach), task, k, n)
    return n


@step
def visit_ball(world: World, grid: Record, ball: Ball, task: int, k: int, n: int) -> int:
    """Do something, for sphere k, at all cells of a grid that come within a ball. Returns how many are listed now."""
    cells = world.cells
    x, y, z, reach = ball
    # in cells, and one division a ball
    per_side, last_z = 1.0 / grid.side[2], float(grid.shape[2] - 1)
    middle = (z - grid.low[2]) * per_side
    for ix in range(index(grid, 0, x - reach), index(grid, 0, x + reach) + 1):
        gap_x = distance_to_cell(grid, 0, ix, x)
        for iy in range(index(grid, 1, y - reach), index(grid, 1, y + reach) + 1):
            gap_y = distance_to_cell(grid, 1, iy, y)
            rest = reach * reach - gap_x * gap_x - gap_y * gap_y
            if rest < 0.0:
                continue
            half = sqrt(rest) * per_side
            column = cell_number(grid, ix, iy, 0)
            first = column + int(min(max(middle - half, 0.0), last_z))
            last = column + int(min(max(middle + half, 0.0), last_z))
            for cell in range(first, last + 1):
                if task == CellTask.GATHER:
                    n = gather_cell(cells, cell, world.scratch.found, n)
                elif task == CellTask.REGISTER:
                    register(cells, cell, k)
                else:
                    no_longer(cells.larger[np.uintp(cell)], k)
    return n


@step
def visit_registered(world: World, task: int, k: int, n: int) -> int:
    """Do the same at the cells that are kept."""
    cells, found, empty = world.cells, world.scratch.found, world.cells.following.size - 1
    first, count = cells.anchors[k].first, cells.anchors[k].count
    begin = n
    for m in range(first, first + count):
        cell = cells.registered_at[np.uintp(m)]
        if task == CellTask.GATHER:
            p = cells.heads[np.uintp(cell)]
            found[np.uintp(n)] = p
            n += p != empty
        else:
            no_longer(cells.larger[np.uintp(cell)], k)
    return gather_following(cells, found, begin, n)


@step
def register(cells: Cells, cell: int, k: int) -> None:
    """Register sphere k among the larger ones near a cell."""
    larger, anchor = cells.larger[np.uintp(cell)], cells.anchors[k]
    if larger.count < LARGER_CAPACITY:
        larger.who[larger.count] = k
    # beyond the capacity for good: who was not registered is not known any more
    larger.count = min(larger.count + 1, LARGER_CAPACITY + 1)
    if anchor.first >= 0:
        cells.registered_at[anchor.first + anchor.count] = cell
        anchor.count += 1


@step
def no_longer(larger: Record, k: int) -> None:
    """Sphere k is no longer among the larger ones near a cell."""
    if larger.count <= LARGER_CAPACITY:
        for m in range(larger.count):
            if larger.who[m] == k:
                larger.count -= 1
                larger.who[m] = larger.who[larger.count]
                break


@step
def gather_larger(world: World, k: int, cell: int, now: float, n: int) -> int:
    """Append the larger spheres that sphere k can touch while it is in its cell."""
    cells, found = world.cells, world.scratch.found
    registered = cells.larger[cell]
    if registered.count <= LARGER_CAPACITY:
        for m in range(registered.count):
            found[n] = registered.who[m]
            n += 1
        return n
    motion, own = world.spheres.motions[k], world.spheres.schedule[k].size_class
    flown, side = now - motion.time, cells.grids[own].side
    x = motion.position[0] + motion.velocity[0] * flown
    y = motion.position[1] + motion.velocity[1] * flown
    z = motion.position[2] + motion.velocity[2] * flown
    across = sqrt(side[0] * side[0] + side[1] * side[1] + side[2] * side[2])
    for coarser in range(own):
        grid = cells.grids[coarser]
        # the one flies through its cell, the other through its margin from end to end
        reach = motion.radius + grid.largest + 2.0 * grid.margin + 1.001 * across
        n = visit_ball(world, grid, Ball(x, y, z, reach), CellTask.GATHER, k, n)
    return n
