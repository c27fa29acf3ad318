"""Spheres that are placed, in cells: which are near a place, and which places none of the others can take.

A grid for each factor of two in size; a sphere stands in that of its own. Cells are at least the largest diameter of
their grid, so that 27 of them hold all that can be in the way of a sphere no larger.

Most places are refused: one in forty is free while a million equal spheres fill .3 of their box. So each cell has 64
voxels, a bit each, which is set once a sphere is in the way of every one that would be put anywhere into the voxel. Of
the places that are not free such a bit refuses nine in ten.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.kernel import inner, kernel
from harness.prefetch import prefetch

Integers = NDArray[np.int64]
Indices = NDArray[np.int32]
Bits = NDArray[np.uint64]

VOXELS = 4
"""In a cell, along an axis: a power of two, of which the cube is the number of bits of a word."""
SHIFT, LAST = 2, 3
# Of a distance: what rounding of a place's voxel, and of its distance from the place, stays far below.
ROUNDING = 1e-6
Place = tuple[float, float, float]


# What a search reads of a sphere, on one cache line.
SPHERE = np.dtype(
    {
        "names": ["position", "radius", "following"],
        "formats": [(np.float64, 3), np.float64, np.int32],
        "itemsize": 64,
    }
)


class PlacedSpheres(NamedTuple):
    """Spheres of which some are placed.

    Attributes
    ----------
    spheres : (n,) of SPHERE, the largest first; positions in m are written as they are placed, and which sphere was
        placed before in the same cell, or -1
    radii : (n,) m, the same
    half : (3,) m, half the sides of the box
    levels : (n,) number of each sphere's grid
    cells : (levels, 3) of each grid, along each axis
    offsets : (levels,) the first cell of each grid in `heads` and `taken`
    largest, least : (levels,) m, the largest and the smallest radius
    heads : (cells,) the sphere placed last in each cell, or -1
    taken : (cells,) of each voxel a bit, set where a sphere of the same grid is in the way of the smallest of it
    """

    spheres: Any
    radii: Floats
    half: Floats
    levels: Integers
    cells: Integers
    offsets: Integers
    largest: Floats
    least: Floats
    heads: Indices
    taken: Bits


class Grid(NamedTuple):
    """One of the grids; numbers only, which a loop keeps in registers.

    Attributes
    ----------
    x, y, z : m, half the sides of the box
    nx, ny, nz : cells along each axis
    per_x, per_y, per_z : cells a metre
    first : number of the first cell
    """

    x: float
    y: float
    z: float
    nx: int
    ny: int
    nz: int
    per_x: float
    per_y: float
    per_z: float
    first: int


def none_placed(radii: Floats, half: Floats) -> PlacedSpheres:
    """Of spheres with these radii (n,), m, the largest first, in a box with these halves of its sides (3,), m."""
    count = len(radii)
    _, levels = np.unique(np.floor(np.log2(radii[0] / radii)), return_inverse=True)
    first = np.searchsorted(levels, np.arange(levels[-1] + 1))
    last = np.append(first[1:], count) - 1
    cells = np.array([_cells(2 * radii[k], int(end - k + 1), half) for k, end in zip(first, last, strict=True)])
    ends = np.cumsum(cells.prod(axis=1))
    spheres = np.zeros(count, SPHERE)
    spheres["radius"] = radii
    return PlacedSpheres(
        spheres=spheres,
        radii=radii,
        half=half,
        levels=levels,
        cells=cells,
        offsets=ends - cells.prod(axis=1),
        largest=radii[first],
        least=radii[last],
        heads=np.full(ends[-1], -1, np.int32),
        taken=np.zeros(ends[-1], np.uint64),
    )


def _cells(diameter: float, count: int, half: Floats) -> Integers:
    """(3,) int array: cells along each axis, none smaller than the diameter, and not many more than spheres."""
    cells = np.maximum(np.minimum(2 * half / diameter, 1e6), 1).astype(np.int64)
    while cells.prod() > 4 * count + 64:
        cells[cells.argmax()] = (cells.max() + 1) // 2
    return cells


@inner
def grid_of(placed: PlacedSpheres, level: int) -> Grid:
    """The grid of a level."""
    x, y, z = placed.half[0], placed.half[1], placed.half[2]
    nx, ny, nz = placed.cells[level, 0], placed.cells[level, 1], placed.cells[level, 2]
    return Grid(
        x,
        y,
        z,
        nx,
        ny,
        nz,
        per_x=nx / (2 * x),
        per_y=ny / (2 * y),
        per_z=nz / (2 * z),
        first=placed.offsets[level],
    )


@inner
def put(placed: PlacedSpheres, body: int, place: Place) -> None:
    """Put a sphere at a place where no other is in its way."""
    level = placed.levels[body]
    grid = grid_of(placed, level)
    sphere = placed.spheres[body]
    x, y, z = place
    sphere.position[0], sphere.position[1], sphere.position[2] = x, y, z
    ix = along((x + grid.x) * grid.per_x, grid.nx)
    iy = along((y + grid.y) * grid.per_y, grid.ny)
    iz = along((z + grid.z) * grid.per_z, grid.nz)
    cell = grid.first + (ix * grid.ny + iy) * grid.nz + iz
    sphere.following = placed.heads[cell]
    placed.heads[cell] = body
    take(placed.taken, grid, place, placed.radii[body] + placed.least[level])


@inner
def take(taken: Bits, grid: Grid, place: Place, reach: float) -> None:
    """Set the bits of all voxels that lie within reach of a place, m."""
    per_x, per_y, per_z = VOXELS * grid.per_x, VOXELS * grid.per_y, VOXELS * grid.per_z
    u, v, w = (place[0] + grid.x) * per_x, (place[1] + grid.y) * per_y, (place[2] + grid.z) * per_z
    reach *= 1 - ROUNDING
    for x in range(max(math.ceil(u - reach * per_x), 0), min(math.floor(u + reach * per_x), VOXELS * grid.nx)):
        away = max(u - x, x + 1 - u) / per_x
        left = reach * reach - away * away
        reach_y = math.sqrt(left) * per_y if left > 0 else -1.0
        for y in range(max(math.ceil(v - reach_y), 0), min(math.floor(v + reach_y), VOXELS * grid.ny)):
            away = max(v - y, y + 1 - v) / per_y
            rest = left - away * away
            reach_z = math.sqrt(rest) * per_z if rest > 0 else -1.0
            begin, end = max(math.ceil(w - reach_z), 0), min(math.floor(w + reach_z), VOXELS * grid.nz)
            row = grid.first + ((x >> SHIFT) * grid.ny + (y >> SHIFT)) * grid.nz
            bits = ((x & LAST) << SHIFT | (y & LAST)) << SHIFT
            while begin < end:  # to the end of a cell
                to = min(end, (begin | LAST) + 1)
                taken[row + (begin >> SHIFT)] |= np.uint64(((1 << (to - begin)) - 1) << ((begin & LAST) + bits))
                begin = to


@inner
def voxel_of(grid: Grid, place: Place) -> tuple[int, int]:
    """Where the bit of a place is: its cell, and its number among the cell's."""
    x = along((place[0] + grid.x) * (VOXELS * grid.per_x), VOXELS * grid.nx)
    y = along((place[1] + grid.y) * (VOXELS * grid.per_y), VOXELS * grid.ny)
    z = along((place[2] + grid.z) * (VOXELS * grid.per_z), VOXELS * grid.nz)
    cell = grid.first + ((x >> SHIFT) * grid.ny + (y >> SHIFT)) * grid.nz + (z >> SHIFT)
    return cell, ((x & LAST) << SHIFT | (y & LAST)) << SHIFT | (z & LAST)


@inner
def is_free(placed: PlacedSpheres, body: int, place: Place, near: Indices) -> bool:
    """Whether no sphere that is placed overlaps this one at this place; (27,) `near` is written."""
    for share in SHARES:
        for level in range(placed.levels[body] + 1):
            reach = share * (placed.radii[body] + placed.largest[level])
            count = gather(placed, grid_of(placed, level), place, reach, near)
            if overlaps(placed, near[:count], place, placed.radii[body]):
                return False
    return True


# A place's own cell is searched before those around it: what is in the way is most often there.
SHARES = (0.0, 1.0)


@inner
def gather(placed: PlacedSpheres, grid: Grid, place: Place, reach: float, near: Indices) -> int:
    """Write the sphere placed last in each cell within reach of a place, m, where there is one; returns how many."""
    x, y, z = place[0] + grid.x, place[1] + grid.y, place[2] + grid.z
    from_y, to_y = along((y - reach) * grid.per_y, grid.ny), along((y + reach) * grid.per_y, grid.ny)
    from_z, to_z = along((z - reach) * grid.per_z, grid.nz), along((z + reach) * grid.per_z, grid.nz)
    count = 0
    for ix in range(along((x - reach) * grid.per_x, grid.nx), along((x + reach) * grid.per_x, grid.nx) + 1):
        for iy in range(from_y, to_y + 1):
            row = grid.first + (ix * grid.ny + iy) * grid.nz
            for cell in range(row + from_z, row + to_z + 1):
                near[count] = placed.heads[cell]
                count += placed.heads[cell] >= 0  # no branch, which would be mispredicted half the time
    return count


@inner
def overlaps(placed: PlacedSpheres, last: Indices, place: Place, radius: float) -> bool:
    """Whether one of these spheres, or of those placed before in their cells, overlaps one at a place."""
    for other in last:
        while other >= 0:
            sphere = placed.spheres[other]
            dx = place[0] - sphere.position[0]
            dy = place[1] - sphere.position[1]
            dz = place[2] - sphere.position[2]
            touch = radius + sphere.radius
            if dx * dx + dy * dy + dz * dz < touch * touch:
                return True
            other = sphere.following
    return False


@inner
def along(coordinate: float, cells: int) -> int:
    """The cell of a coordinate along an axis, in cells from where they begin; the outermost ones reach to infinity."""
    return min(max(int(coordinate), 0), cells - 1)


@kernel
def not_taken(placed: PlacedSpheres, body: int, draws: Floats, left: Integers) -> int:
    """Which of a few draws no bit refuses; what a search for these reads is in the caches soon after.

    Parameters
    ----------
    placed : PlacedSpheres
    body : the sphere to place first
    draws : (m, 3), as of `place_of`
    left : (m,) written with their numbers, in order

    Returns
    -------
    int
        How many; all of them, unless the spheres that they may be for are equal.
    """
    radius, level = placed.radii[body], placed.levels[body]
    grid, taken = grid_of(placed, level), placed.taken
    alike = radius == placed.radii[min(body + len(draws), len(placed.radii)) - 1]
    cells, bits = np.empty(len(draws), np.int64), np.empty(len(draws), np.uint64)
    for k in range(len(draws)):
        cell, bit = voxel_of(grid, place_of(placed, draws[k], radius))
        cells[k], bits[k] = cell, np.uint64(bit)
        prefetch(taken, cell)
    count = 0
    for k in range(len(draws)):
        left[count] = k
        count += not alike or not (taken[cells[k]] >> bits[k]) & np.uint64(1)
    prefetch_around(placed, grid, cells, left[:count])
    return count


@inner
def prefetch_around(placed: PlacedSpheres, grid: Grid, cells: Integers, left: Integers) -> None:
    """Prefetch what will be searched for some of the draws, of which the cells are given: most of it was waiting."""
    for k in left:
        for row in range(9):
            prefetch(placed.heads, cells[k] + ((row // 3 - 1) * grid.ny + row % 3 - 1) * grid.nz)
    for k in left:
        for row in range(9):
            middle = cells[k] + ((row // 3 - 1) * grid.ny + row % 3 - 1) * grid.nz
            for cell in range(max(middle - 1, 0), min(middle + 2, len(placed.heads))):
                prefetch(placed.spheres, placed.heads[cell])


@inner
def place_of(placed: PlacedSpheres, draw: Floats, radius: float) -> Place:
    """Where three uniform numbers put a sphere, m."""
    x, y, z = max(placed.half[0] - radius, 0.0), max(placed.half[1] - radius, 0.0), max(placed.half[2] - radius, 0.0)
    return (2 * draw[0] - 1) * x, (2 * draw[1] - 1) * y, (2 * draw[2] - 1) * z
