"""Cells: which spheres a sphere can touch before it leaves its own cell and the 26 around it.

A grid for each size class, with cells of about the diameter of the largest in it; a sphere stands only in its own grid.
It crosses into the next cell by an event of its own, and then looks only at the layer of cells that are new to it.

A sphere meets larger ones through the 27 cells around it in their grids, each time it looks. It meets smaller ones
through the cells of theirs that a ball around it covers, as far as it can fly before it looks again (`margin`). A
cell of a coarser grid is at least the two radii, the finer cell and two margins wide: then a small sphere that comes
into that ball from outside crosses into its last cell while the large one is among its 27.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.kernel import step
from harness.motion.predictive.state import GRID, Cells, Floats, Indices, Record, Records, Spheres

# Radii of one class are within this ratio.
CLASS_RATIO = 3.0
# Cells of a grid for each of its spheres, at most. Eight still are as fast as fewer at packing .01.
CELLS_PER_SPHERE = 8
# Cells are wider than they must be by this fraction, so that rounding at a crossing cannot lose a neighbour.
SLACK = 1e-6

ALL = 3  # instead of an axis: look at all cells around


class Layer(NamedTuple):
    """Which of the cells around a sphere to look at.

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


def build(half_box: Floats, radii: Floats, skin: float) -> Cells:
    """Empty grids for these spheres.

    Parameters
    ----------
    half_box : (3,) m
    radii : (n,) m
    skin : how much wider than a diameter the cells must be, m (for neighbour lists)
    """
    classes = size_classes(radii)
    grids = np.zeros(int(classes.max(initial=0)) + 1, dtype=GRID)
    needed = np.zeros(3)
    finer = 0.0
    width = np.inf  # of the narrowest cell of a finer grid
    for level in reversed(range(len(grids))):
        members = radii[classes == level]
        largest = float(members.max(initial=0.0))
        # few small spheres stand in wide cells: a margin of their own size would be flown through again and again
        margin = max(0.1 * largest, 0.5 * finer, 0.25 * width) if finer else 0.0
        least = np.maximum(2.0 * largest + skin, needed + largest + 2.0 * margin if finer else 0.0)
        shape = cell_counts(
            half_box, least * (1.0 + SLACK) + 1e-14 * half_box.max(), CELLS_PER_SPHERE * len(members) + 27
        )
        side = 2.0 * half_box / shape
        grids[level] = shape, 0, -half_box, side, largest, margin
        finer, width = max(finer, largest), min(width, float(side.min()))
        needed = np.maximum(needed, side + largest)
    sizes = grids["shape"].prod(axis=1)
    grids["first"] = np.concatenate(([0], np.cumsum(sizes)[:-1]))
    count = len(radii)
    return Cells(
        heads=np.full(int(sizes.sum()), count, dtype=np.uint32),
        following=np.full(count + 1, count, dtype=np.uint32),
        grids=grids,
        renewals=np.full(count, np.inf),
    )


def size_classes(radii: Floats) -> NDArray[np.int32]:
    """(n,) class of each sphere, 0 the largest; classes without a sphere are left out."""
    classes = np.zeros(len(radii), dtype=np.int32)
    rest = radii
    while len(rest := rest[rest * CLASS_RATIO < rest.max(initial=0.0)]):
        classes[radii <= rest.max()] += 1
    return classes


def cell_counts(half_box: Floats, least: Floats, most: int) -> NDArray[np.int64]:
    """(3,) cells along each axis, none smaller than `least` (3,) unless alone on its axis, `most` in all."""

    def counts(growth: float) -> NDArray[np.int64]:
        return np.maximum(np.minimum(2.0 * half_box / (least * growth), 1e9).astype(np.int64), 1)

    low, high = 1.0, 1.0
    while counts(high).astype(float).prod() > most:
        low, high = high, 2.0 * high
    for _ in range(40 if high > 1.0 else 0):
        middle = sqrt(low * high)
        low, high = (middle, high) if counts(middle).astype(float).prod() > most else (low, middle)
    return counts(high)


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
def settle(cells: Cells, spheres: Spheres, k: int) -> None:
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
def gather_ball(cells: Cells, grid: Record, x: float, y: float, z: float, reach: float, found: Indices, n: int) -> int:
    """Append the spheres of all cells that come within `reach` of a point."""
    for ix in range(index(grid, 0, x - reach), index(grid, 0, x + reach) + 1):
        gap_x = distance_to_cell(grid, 0, ix, x)
        for iy in range(index(grid, 1, y - reach), index(grid, 1, y + reach) + 1):
            gap_y = distance_to_cell(grid, 1, iy, y)
            rest = reach * reach - gap_x * gap_x - gap_y * gap_y
            if rest < 0.0:
                continue
            half = sqrt(rest)
            column = cell_number(grid, ix, iy, 0)
            for iz in range(index(grid, 2, z - half), index(grid, 2, z + half) + 1):
                n = gather_cell(cells, column + iz, found, n)
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
