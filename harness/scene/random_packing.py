"""Random sequential addition: spheres are put at random places, one after another, where no earlier one is in the way.

Largest first: a small sphere finds a hole between large ones, not the other way about. Spheres whose radii differ by up
to a factor of 2 share a grid whose cells are at least their largest diameter, so that 27 cells hold all that can be in
the way of a sphere no larger, at any ratio of sizes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.kernel import inner, kernel

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Indices = NDArray[np.int32]

# Up to so many spheres, and up to this packing, are placed without a kernel, which would take longer to load.
FEW, LOOSE = 1000, 0.3
# Tries for each sphere, on the average. Equal spheres in a large box take a dozen up to a packing of .30.
TRIES = 50
SATURATION = 0.384
"""The packing at which no more equal spheres find room in a large box, however long one tries (Feder 1980)."""


def add_at_random(radii: Floats, half: Floats, rng: np.random.Generator) -> Floats:
    """Centres of spheres inside a box, of which no two overlap.

    Parameters
    ----------
    radii : (n,) float array, m, falling
    half : (3,) float array, m, half the sides of the box; no smaller than any radius
    rng : the source of all randomness

    Returns
    -------
    (m, 3) float array, m
        Of the first m spheres; m < n if room for the next was not found in the tries allowed.
    """
    count = len(radii)
    loose = 4 / 3 * math.pi * float((radii**3).sum()) <= LOOSE * 8 * float(half.prod())
    positions = np.empty((count, 3))
    _, levels = np.unique(np.floor(np.log2(radii[0] / radii)), return_inverse=True)
    first = np.searchsorted(levels, np.arange(levels[-1] + 1))
    cells = np.array([_cells(2 * radii[k], int((levels == level).sum()), half) for level, k in enumerate(first)])
    ends = np.cumsum(cells.prod(axis=1))
    heads, following = np.full(ends[-1], -1, np.int32), np.full(count, -1, np.int32)
    grids = _Grids(levels, cells, ends - cells.prod(axis=1), radii[first], heads, following)
    spheres = _Spheres(positions, radii, half)

    done, tries = 0, TRIES * count + 100_000
    while done < count and tries > 0:
        draws = rng.random((min(tries, max(1024, min(4 * (count - done), 1 << 18))), 3))
        done = _add_few(done, spheres, draws) if count <= FEW and loose else _add(done, spheres, draws, grids)
        tries -= len(draws)
    return positions[:done]


class _Spheres(NamedTuple):
    """Those to place.

    Attributes
    ----------
    positions : (n, 3) m, written as they are placed
    radii : (n,) m, the largest first
    half : (3,) m, half the sides of the box
    """

    positions: Floats
    radii: Floats
    half: Floats


class _Grids(NamedTuple):
    """A grid for each factor of two in size; a sphere stands in that of its own.

    Attributes
    ----------
    levels : (n,) of each sphere
    cells : (levels, 3) along each axis
    offsets : (levels,) the first cell of each level in `heads`
    largest : (levels,) m, the largest radius
    heads : (cells,) the sphere placed last in each cell, or -1
    following : (n,) the sphere placed before in the same cell, or -1
    """

    levels: Integers
    cells: Integers
    offsets: Integers
    largest: Floats
    heads: Indices
    following: Indices


def _cells(diameter: float, count: int, half: Floats) -> Integers:
    """(3,) int array: cells along each axis, none smaller than the diameter, and not many more than spheres."""
    cells = np.maximum(np.minimum(2 * half / diameter, 1e6), 1).astype(np.int64)
    while cells.prod() > 4 * count + 64:
        cells[cells.argmax()] = (cells.max() + 1) // 2
    return cells


def _add_few(done: int, spheres: _Spheres, draws: Floats) -> int:
    """As `_add`, to the bit: some draws at once against all spheres that are placed, more where few are free."""
    positions, radii, half = spheres
    at_once = _AT_ONCE[0]
    while len(draws) and done < len(radii):
        some, radius = draws[:at_once], radii[done]
        places = (2 * some - 1) * np.maximum(half - radius, 0.0)
        gaps, touch = places[:, None, :] - positions[:done], radius + radii[:done]
        squares = gaps[..., 0] * gaps[..., 0] + gaps[..., 1] * gaps[..., 1] + gaps[..., 2] * gaps[..., 2]
        free = ~(squares < touch * touch).any(axis=1)
        first = int(free.argmax())
        if not free[first]:
            draws, at_once = draws[len(some) :], min(2 * at_once, _AT_ONCE[1])
        else:
            positions[done] = places[first]
            draws, done, at_once = draws[first + 1 :], done + 1, _AT_ONCE[0]
    return done


# Draws, the fewest and the most: of twelve one is free in a fluid of packing .3.
_AT_ONCE = (16, 256)


@kernel
def _add(done: int, spheres: _Spheres, draws: Floats, grids: _Grids) -> int:
    """Place spheres from `done` on with (m, 3) uniform draws until either are used up; returns how many are placed."""
    place = np.empty(3)
    radii, half = spheres.radii, spheres.half
    for draw in draws:
        if done == len(radii):
            break
        for axis in range(3):
            place[axis] = (2 * draw[axis] - 1) * max(half[axis] - radii[done], 0.0)
        if _free(done, place, spheres, grids):
            spheres.positions[done] = place
            level = grids.levels[done]
            cell = _cell(place, half, grids.cells[level], grids.offsets[level])
            grids.following[done] = grids.heads[cell]
            grids.heads[cell] = done
            done += 1
    return done


# The cells around a place are searched from the inside out: what is in the way is most often in its own cell or in one
# of the eight nearest, and most places are refused.
_SHARES = (0.0, 0.5, 1.0)


@inner
def _free(body: int, place: Floats, spheres: _Spheres, grids: _Grids) -> bool:
    """Whether no sphere that is placed overlaps this one at this place."""
    radius, half = spheres.radii[body], spheres.half
    for share in _SHARES:
        for level in range(grids.levels[body] + 1):
            reach = share * (radius + grids.largest[level])
            nx, ny, nz = grids.cells[level, 0], grids.cells[level, 1], grids.cells[level, 2]
            from_z, to_z = _along(place[2] - reach, half[2], nz), _along(place[2] + reach, half[2], nz)
            for x in range(_along(place[0] - reach, half[0], nx), _along(place[0] + reach, half[0], nx) + 1):
                for y in range(_along(place[1] - reach, half[1], ny), _along(place[1] + reach, half[1], ny) + 1):
                    row = grids.offsets[level] + (x * ny + y) * nz
                    if _overlaps(radius, place, row + from_z, row + to_z, spheres, grids):
                        return False
    return True


@inner
def _overlaps(radius: float, place: Floats, begin: int, end: int, spheres: _Spheres, grids: _Grids) -> bool:
    """Whether a sphere in the cells from one up to and including another overlaps one of this radius at this place."""
    positions, radii = spheres.positions, spheres.radii
    for cell in range(begin, end + 1):
        other = grids.heads[cell]
        while other >= 0:
            dx = place[0] - positions[other, 0]
            dy = place[1] - positions[other, 1]
            dz = place[2] - positions[other, 2]
            touch = radius + radii[other]
            if dx * dx + dy * dy + dz * dz < touch * touch:
                return True
            other = grids.following[other]
    return False


@kernel
def _cell(place: Floats, half: Floats, cells: Integers, offset: int) -> int:
    """The cell of a place in a grid that begins at an offset."""
    x, y = _along(place[0], half[0], cells[0]), _along(place[1], half[1], cells[1])
    return offset + int((x * cells[1] + y) * cells[2]) + _along(place[2], half[2], cells[2])


@kernel
def _along(coordinate: float, half: float, cells: int) -> int:
    """The cell of a coordinate along an axis; the outermost ones reach to infinity."""
    return min(max(math.floor((coordinate + half) * (cells / (2 * half))), 0), cells - 1)
