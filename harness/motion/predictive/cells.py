"""Cells: which spheres a sphere can touch before it leaves its own cell and the 26 around it.

A grid for each size class, with cells of about the diameter of the largest in it; a sphere stands only in its own grid.
It crosses into the next cell by an event of its own, and then looks only at the layer of cells that are new to it.

A sphere meets larger ones through the 27 cells around it in their grids, each time it looks. It meets smaller ones
through the cells of theirs that a ball around it covers, as far as it can fly before it looks again (`margin`). A
cell of a coarser grid is at least the two radii, the finer cell and two margins wide: then a small sphere that comes
into that ball from outside crosses into its last cell while the large one is among its 27.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from harness.kernel import step
from harness.motion.predictive.state import GRID, PLACE, Cells, Floats, Indices, Ints, X

# Radii of one class are within this ratio.
CLASS_RATIO = 3.0
# Cells of a grid for each of its spheres, at most. Eight still are as fast as fewer at packing .01.
CELLS_PER_SPHERE = 8
# Cells are wider than they must be by this fraction, so that rounding at a crossing cannot lose a neighbour.
SLACK = 1e-6

ALL = 3  # instead of an axis: look at all cells around


def build(half_box: Floats, radii: Floats, skin: float) -> Cells:
    """Empty grids for these spheres.

    Parameters
    ----------
    half_box : (3,) m
    radii : (n,) m
    skin : how much wider than a diameter the cells must be, m (for neighbour lists)
    """
    classes = size_classes(radii)
    grids = int(classes.max(initial=0)) + 1
    shapes = np.ones((grids, 4), dtype=np.int64)
    frames = np.zeros((grids, 8))
    needed = np.zeros(3)
    finer = 0.0
    width = np.inf  # of the narrowest cell of a finer grid
    for grid in reversed(range(grids)):
        members = radii[classes == grid]
        largest = float(members.max(initial=0.0))
        # few small spheres stand in wide cells: a margin of their own size would be flown through again and again
        margin = max(0.1 * largest, 0.5 * finer, 0.25 * width) if finer else 0.0
        least = np.maximum(2.0 * largest + skin, needed + largest + 2.0 * margin if finer else 0.0)
        shape = cell_counts(
            half_box, least * (1.0 + SLACK) + 1e-14 * half_box.max(), CELLS_PER_SPHERE * len(members) + 27
        )
        shapes[grid, :3] = shape
        frames[grid, :3] = -half_box
        frames[grid, 3:6] = 2.0 * half_box / shape
        frames[grid, 6:] = largest, margin
        finer, width = max(finer, largest), min(width, float(frames[grid, 3:6].min()))
        needed = np.maximum(needed, frames[grid, 3:6] + largest)
    sizes = shapes[:, :3].prod(axis=1)
    shapes[:, 3] = np.concatenate(([0], np.cumsum(sizes)[:-1]))
    count = len(radii)
    return Cells(
        heads=np.full(int(sizes.sum()), count, dtype=np.uint32),
        following=np.full(count + 1, count, dtype=np.uint32),
        shapes=shapes,
        frames=frames,
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
def index(cells: Cells, grid: int, axis: int, x: float) -> int:
    """Cell along an axis; the outermost cells reach out to infinity."""
    place = (x - cells.frames[grid, axis]) / cells.frames[grid, 3 + axis]
    return int(min(max(place, 0.0), float(cells.shapes[grid, axis] - 1)))


@step
def cell_number(cells: Cells, grid: int, ix: int, iy: int, iz: int) -> int:
    """Place of a cell in `heads`."""
    return int(cells.shapes[grid, 3] + (ix * cells.shapes[grid, 1] + iy) * cells.shapes[grid, 2] + iz)


@step
def cell_of(cells: Cells, marks: Ints, k: int) -> int:
    """Place in `heads` of the cell in which sphere k stands."""
    return cell_number(cells, marks[k, GRID], marks[k, PLACE], marks[k, PLACE + 1], marks[k, PLACE + 2])


@step
def insert(cells: Cells, marks: Ints, k: int) -> None:
    """Sphere k becomes the first of the cell that its marks name."""
    cell = cell_of(cells, marks, k)
    cells.following[k] = cells.heads[cell]
    cells.heads[cell] = k


@step
def remove(cells: Cells, marks: Ints, k: int) -> None:
    """Sphere k leaves its cell."""
    cell = cell_of(cells, marks, k)
    following = cells.following
    p = cells.heads[cell]
    if p == k:
        cells.heads[cell] = following[k]
    else:
        while following[p] != k:
            p = following[p]
        following[p] = following[k]


@step
def settle(cells: Cells, rows: Floats, marks: Ints, k: int) -> None:
    """Put sphere k, which stands in no cell, where its row says."""
    for axis in range(3):
        marks[k, PLACE + axis] = index(cells, marks[k, GRID], axis, rows[k, X + axis])
    insert(cells, marks, k)


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
def block(
    cells: Cells, grid: int, ix: int, iy: int, iz: int, axis: int, step: int
) -> tuple[int, int, int, int, int, int]:
    """First and last cell, on each axis, of the 27 around one, or of the layer of 9 that lies ahead along an axis."""
    shapes = cells.shapes
    from_x, to_x = max(ix - 1, 0), min(ix + 1, shapes[grid, 0] - 1)
    from_y, to_y = max(iy - 1, 0), min(iy + 1, shapes[grid, 1] - 1)
    from_z, to_z = max(iz - 1, 0), min(iz + 1, shapes[grid, 2] - 1)
    if axis == 0:
        from_x, to_x = max(from_x, ix + step), min(to_x, ix + step)
    elif axis == 1:
        from_y, to_y = max(from_y, iy + step), min(to_y, iy + step)
    elif axis == 2:
        from_z, to_z = max(from_z, iz + step), min(to_z, iz + step)
    return from_x, to_x, from_y, to_y, from_z, to_z


@step
def gather_around(
    cells: Cells, grid: int, ix: int, iy: int, iz: int, axis: int, step: int, found: Indices, n: int
) -> int:
    """Append the spheres of the 27 cells around one, or of the layer of 9 that lies ahead along an axis."""
    from_x, to_x, from_y, to_y, from_z, to_z = block(cells, grid, ix, iy, iz, axis, step)
    for x in range(from_x, to_x + 1):
        for y in range(from_y, to_y + 1):
            cell = cell_number(cells, grid, x, y, 0)
            for z in range(from_z, to_z + 1):
                n = gather_cell(cells, cell + z, found, n)
    return n


@step
def gather_ball(cells: Cells, grid: int, x: float, y: float, z: float, reach: float, found: Indices, n: int) -> int:
    """Append the spheres of all cells that come within `reach` of a point."""
    for ix in range(index(cells, grid, 0, x - reach), index(cells, grid, 0, x + reach) + 1):
        gap_x = distance_to_cell(cells, grid, 0, ix, x)
        for iy in range(index(cells, grid, 1, y - reach), index(cells, grid, 1, y + reach) + 1):
            gap_y = distance_to_cell(cells, grid, 1, iy, y)
            rest = reach * reach - gap_x * gap_x - gap_y * gap_y
            if rest < 0.0:
                continue
            half = sqrt(rest)
            column = cell_number(cells, grid, ix, iy, 0)
            for iz in range(index(cells, grid, 2, z - half), index(cells, grid, 2, z + half) + 1):
                n = gather_cell(cells, column + iz, found, n)
    return n


@step
def distance_to_cell(cells: Cells, grid: int, axis: int, place: int, x: float) -> float:
    """From x to the nearest point of a cell, along an axis."""
    side = cells.frames[grid, 3 + axis]
    low = cells.frames[grid, axis] + place * side
    below = low - x if place > 0 else 0.0
    above = x - (low + side) if place < cells.shapes[grid, axis] - 1 else 0.0
    return max(below, above, 0.0)
