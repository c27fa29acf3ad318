"""Lattices of cells: one for each level of bodies of nearly a size, fitted every frame to where bodies are.

A row of cells along z ends with a cell that is always empty, a plane with such a row, and a lattice with such a plane.
They are the missing neighbours of the cells at the border: no neighbour needs a question whether it exists, and three
neighbours along z are one run of bodies.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.broadphase.pairs import LARGEST, NO_PLACES
from harness.kernel import kernel

Levels = NDArray[np.void]
Level = Any  # one record of Levels, whose fields mypy does not know
Point = tuple[float, float, float]

LEVEL = np.dtype(
    [
        ("reach", np.float64),  # m, the largest radius
        ("least", np.float64),  # m, the smallest radius
        ("budget", np.int64),  # cells it may have
        ("begin", np.int64),  # its bodies have the slots from here
        ("end", np.int64),  # up to here
        ("class_least", np.float64),  # the same of its size class alone
        ("class_budget", np.int64),
        ("class_begin", np.int64),
        ("class_end", np.int64),
        ("first", np.int64),  # its first cell
        ("cells", np.int64),  # how many it has
        ("row", np.int64),  # from a cell to its neighbour along y
        ("plane", np.int64),  # from a cell to its neighbour along x
        *((f"low_{axis}", np.float64) for axis in "xyz"),  # m, where the lattice starts
        *((f"last_{axis}", np.float64) for axis in "xyz"),  # the last cell along the axis, counted from 0
        *((f"scale_{axis}", np.float64) for axis in "xyz"),  # 1/m, cells a length
    ]
)

SLACK = 1e-6
"""Relative surplus of a cell over its largest body: more than rounding can do to fewer than 1e9 cells along an axis."""


class Block(NamedTuple):
    """A block of cells: the first and the last along each axis."""

    x0: int
    x1: int
    y0: int
    y1: int
    z0: int
    z1: int


@kernel
def bounds(positions: Floats, half: Floats) -> tuple[Point, Point]:
    """Where bodies begin and where they end along each axis, m, of those beyond a wall only as seen from within.

    What `require_finite` refuses is refused here too, as a million positions take long to read another time.
    """
    low_x, low_y, low_z = half[0], half[1], half[2]
    high_x, high_y, high_z = -half[0], -half[1], -half[2]
    refused = False
    for i in range(len(positions)):
        x, y, z = positions[i, 0], positions[i, 1], positions[i, 2]
        refused |= not ((abs(x) <= LARGEST) & (abs(y) <= LARGEST) & (abs(z) <= LARGEST))
        low_x, low_y, low_z = min(low_x, x), min(low_y, y), min(low_z, z)
        high_x, high_y, high_z = max(high_x, x), max(high_y, y), max(high_z, z)
    if refused:
        raise ValueError(NO_PLACES)
    return (low_x, low_y, low_z), (high_x, high_y, high_z)


@kernel
def span(coordinates: Floats, half: float) -> tuple[float, float]:
    """Where bodies begin along an axis of the box, m, and over which length they spread."""
    low, high = half, -half
    for i in range(len(coordinates)):
        low = min(low, coordinates[i])
        high = max(high, coordinates[i])
    return within_box(low, high, half)


@kernel
def within_box(low: float, high: float, half: float) -> tuple[float, float]:
    """Where an interval begins along an axis of the box, m, and how long it is there."""
    low = max(low, -half)
    return low, max(0.0, min(high, half) - low)


@kernel
def fit_cells(level: Level, wide: float, deep: float, tall: float) -> None:
    """Choose equal cells, cubes or nearly, that hold a body of the level, but no more of them than its budget."""
    edge = 2.0 * level.reach * (1.0 + SLACK)
    while True:
        nx, ny, nz = cells_along(wide, edge), cells_along(deep, edge), cells_along(tall, edge)
        excess = (nx + 1.0) * (ny + 1.0) * (nz + 1.0) / level.budget
        if excess <= 1.0:
            break
        edge *= max(1.02, excess ** (1.0 / ((nx > 1.0) + (ny > 1.0) + (nz > 1.0))))
    level.row = int(nz) + 1
    level.plane = level.row * (int(ny) + 1)
    level.cells = level.plane * (int(nx) + 1)
    level.last_x, level.last_y, level.last_z = nx - 1.0, ny - 1.0, nz - 1.0
    level.scale_x = nx / wide if nx > 1.0 else 0.0
    level.scale_y = ny / deep if ny > 1.0 else 0.0
    level.scale_z = nz / tall if nz > 1.0 else 0.0


@kernel
def cells_along(length: float, edge: float) -> float:
    """How many cells fit, at least one."""
    return max(1.0, math.floor(length / edge))


class Lattice(NamedTuple):
    """The numbers of a level that lead from a point to a cell; see LEVEL."""

    first: int
    row: int
    plane: int
    low_x: float
    low_y: float
    low_z: float
    last_x: float
    last_y: float
    last_z: float
    scale_x: float
    scale_y: float
    scale_z: float


@kernel
def lattice_of(level: Level) -> Lattice:
    """The lattice of a level, in registers: a loop that writes to memory need not read it for every body."""
    return Lattice(
        first=level.first,
        row=level.row,
        plane=level.plane,
        low_x=level.low_x,
        low_y=level.low_y,
        low_z=level.low_z,
        last_x=level.last_x,
        last_y=level.last_y,
        last_z=level.last_z,
        scale_x=level.scale_x,
        scale_y=level.scale_y,
        scale_z=level.scale_z,
    )


@kernel
def cell_in(lattice: Lattice, x: float, y: float, z: float) -> int:
    """The cell of a lattice at a point, m; beyond the border, the nearest."""
    ix = cell_along(x, lattice.low_x, lattice.scale_x, lattice.last_x)
    iy = cell_along(y, lattice.low_y, lattice.scale_y, lattice.last_y)
    iz = cell_along(z, lattice.low_z, lattice.scale_z, lattice.last_z)
    return lattice.first + ix * lattice.plane + iy * lattice.row + iz


@kernel
def cell_along(x: float, low: float, scale: float, last: float) -> int:
    """Cell along an axis. It never decreases with x, whatever is rounded: `block_around` relies on it."""
    return int(min(max((x - low) * scale, 0.0), last))


@kernel
def block_around(lattice: Lattice, x: float, y: float, z: float, reach: float) -> Block:
    """The cells of a lattice within reach of a point along each axis: no body there is in any other cell."""
    return Block(
        cell_along(x - reach, lattice.low_x, lattice.scale_x, lattice.last_x),
        cell_along(x + reach, lattice.low_x, lattice.scale_x, lattice.last_x),
        cell_along(y - reach, lattice.low_y, lattice.scale_y, lattice.last_y),
        cell_along(y + reach, lattice.low_y, lattice.scale_y, lattice.last_y),
        cell_along(z - reach, lattice.low_z, lattice.scale_z, lattice.last_z),
        cell_along(z + reach, lattice.low_z, lattice.scale_z, lattice.last_z),
    )


@kernel
def cells_of(level: Level) -> float:
    """Cells of a level in which bodies can be, without the empty border."""
    return float((level.last_x + 1.0) * (level.last_y + 1.0) * (level.last_z + 1.0))


@kernel
def cells_covered(reach: float, scale: float, last: float) -> float:
    """Cells along an axis within reach of a point, on average, m and 1/m."""
    return min(1.0 + 2.0 * reach * scale, 1.0 + last)
