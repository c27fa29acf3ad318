"""Cells: which spheres a sphere can touch before it leaves its own cell and the 26 around it.

There is a grid for each size class, and a sphere stands only in its own. It crosses into the next cell by an event of
its own, and then searches only the layer of cells that are new to it.

Spheres of different grids find each other as `harness.motion.predictive.larger` says.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from harness.kernel import step
from harness.motion.predictive.state import Cells, Indices, Record, Records, Spheres

ALL = 3  # instead of an axis: all the cells around


class Layer(NamedTuple):
    """Which of the cells around a sphere are to be searched.

    axis : 0, 1, 2: the layer of 9 that lies ahead along it; `ALL`: all 27
    step : 1 up the axis, -1 down
    """

    axis: int
    step: int


AROUND = Layer(ALL, 0)


class Block(NamedTuple):
    """The first and the last cell along each axis."""

    from_x: int
    to_x: int
    from_y: int
    to_y: int
    from_z: int
    to_z: int


@step
def index(grid: Record, axis: int, x: float) -> int:
    """Cell along an axis; the outermost cells reach out to infinity."""
    place = (x - grid.low[axis]) / grid.side[axis]
    return int(min(max(place, 0.0), float(grid.shape[axis] - 1)))


@step
def cell_number(grid: Record, ix: int, iy: int, iz: int) -> int:
    """Place of a cell in `heads`."""
    return int(grid.first + (ix * grid.shape[1] + iy) * grid.shape[2] + iz)


@step
def cell_of(cells: Cells, sphere: Record) -> int:
    """Place in `heads` of the cell in which a sphere stands."""
    return cell_number(cells.grids[sphere.size_class], sphere.cell[0], sphere.cell[1], sphere.cell[2])


@step
def layer_beyond(face: int) -> Layer:
    """The layer of cells beyond a face of a cell: x-, x+, y-, y+, z-, z+."""
    return Layer(face // 2, 2 * (face % 2) - 1)


@step
def cross(cells: Cells, schedule: Records, k: int) -> Layer:
    """Sphere k goes through the face of its cell that its event names. Returns the layer that is new to it."""
    layer = layer_beyond(schedule[k].face)
    remove(cells, schedule, k)
    schedule[k].cell[layer.axis] += layer.step
    insert(cells, schedule, k)
    return layer


@step
def insert(cells: Cells, schedule: Records, k: int) -> None:
    """Sphere k becomes the first of the cell that its record names."""
    cell = cell_of(cells, schedule[k])
    cells.following[k] = cells.heads[cell]
    cells.heads[cell] = k


@step
def remove(cells: Cells, schedule: Records, k: int) -> None:
    """Sphere k leaves its cell."""
    cell = cell_of(cells, schedule[k])
    following = cells.following
    p = cells.heads[cell]
    if p == k:
        cells.heads[cell] = following[k]
    else:
        while following[p] != k:
            p = following[p]
        following[p] = following[k]


@step
def insert_by_position(cells: Cells, spheres: Spheres, k: int) -> None:
    """Put sphere k, which stands in no cell, where its position says."""
    own = spheres.schedule[k]
    for axis in range(3):
        own.cell[axis] = index(cells.grids[own.size_class], axis, spheres.motions[k].position[axis])
    insert(cells, spheres.schedule, k)


@step
def gather_cell(cells: Cells, cell: int, found: Indices, n: int) -> int:
    """Append the spheres of a cell. Returns the new length."""
    empty = cells.following.size - 1
    p = cells.heads[np.uintp(cell)]
    # Most cells hold one sphere or none, at random: appending without asking spares the mispredicted branch.
    found[np.uintp(n)] = p
    n += p != empty
    p = cells.following[p]
    while p != empty:
        found[np.uintp(n)] = p
        n += 1
        p = cells.following[p]
    return n


@step
def block(grid: Record, ix: int, iy: int, iz: int, layer: Layer) -> Block:
    """The 27 cells around one, or the layer of 9 that lies ahead."""
    axis, step = layer.axis, layer.step
    from_x, to_x = max(ix - 1, 0), min(ix + 1, grid.shape[0] - 1)
    from_y, to_y = max(iy - 1, 0), min(iy + 1, grid.shape[1] - 1)
    from_z, to_z = max(iz - 1, 0), min(iz + 1, grid.shape[2] - 1)
    if axis == 0:
        from_x, to_x = max(from_x, ix + step), min(to_x, ix + step)
    elif axis == 1:
        from_y, to_y = max(from_y, iy + step), min(to_y, iy + step)
    elif axis == 2:
        from_z, to_z = max(from_z, iz + step), min(to_z, iz + step)
    return Block(from_x, to_x, from_y, to_y, from_z, to_z)


@step
def gather_block(cells: Cells, grid: Record, block: Block, found: Indices, n: int) -> int:
    """Append the spheres of a block of cells."""
    for x in range(block.from_x, block.to_x + 1):
        for y in range(block.from_y, block.to_y + 1):
            cell = cell_number(grid, x, y, 0)
            for z in range(block.from_z, block.to_z + 1):
                n = gather_cell(cells, cell + z, found, n)
    return n


@step
def gather_following(cells: Cells, found: Indices, begin: int, n: int) -> int:
    """Append those that follow in their cells, where the first of each cell stand in the list from `begin` on."""
    empty = cells.following.size - 1
    while begin < n:
        end = n
        for m in range(begin, end):
            p = cells.following[found[np.uintp(m)]]
            found[np.uintp(n)] = p
            n += p != empty
        begin = end
    return n


@step
def distance_to_cell(grid: Record, axis: int, place: int, x: float) -> float:
    """From x to the nearest point of a cell, along an axis."""
    side = grid.side[axis]
    low = grid.low[axis] + place * side
    below = low - x if place > 0 else 0.0
    above = x - (low + side) if place < grid.shape[axis] - 1 else 0.0
    return max(below, above, 0.0)


@step
def next_face(grid: Record, axis: int, place: int, up: int) -> float:
    """Where a cell begins along an axis, or the infinity that one moves to beyond the outermost cells."""
    if 0 < place < grid.shape[axis]:
        return float(grid.low[axis] + place * grid.side[axis])
    return inf if up == 1 else -inf
