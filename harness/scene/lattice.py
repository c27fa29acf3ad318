"""Regular places for equal spheres in a box, for packings denser than random placement reaches.

Three lattices of sites a distance d apart, in every orientation to the axes: simple cubic, which suits boxes a few
spheres wide, and the face-centred cubic and hexagonal ones, which fill a large box to 74 %.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

# Room for rounding where spheres fit exactly, as eight of diameter 1 do in a box of side 2.
EXACTLY = 1e-12


@dataclass(frozen=True)
class Lattice:
    """Layers along z, of rows along y, of sites along x; all lengths in units of the spacing of neighbours.

    Parameters
    ----------
    row, layer : distances of rows and of layers
    row_shift : along x, of every other row
    layer_shift : along x and y, of every other layer
    """

    row: float
    layer: float
    row_shift: float
    layer_shift: tuple[float, float]

    def lines(self, layer: int, row: int) -> tuple[float, float]:
        """Where a row begins, x and y, for rows and layers counted modulo 2."""
        return (row * self.row_shift + layer * self.layer_shift[0]) % 1.0, layer * self.layer_shift[1] + row * self.row


LATTICES = (
    Lattice(1.0, 1.0, 0.0, (0.0, 0.0)),
    Lattice(1.0, np.sqrt(1 / 2), 0.0, (0.5, 0.5)),
    Lattice(np.sqrt(3 / 4), np.sqrt(2 / 3), 0.5, (0.5, np.sqrt(1 / 12))),
)


def sites(count: int, distance: float, sides: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """At least `count` sites, as far apart as the best of the lattices allows.

    Parameters
    ----------
    count : how many are wanted
    distance : the least distance of two sites
    sides : (3,) float array, sides of the box they must lie in, centred at the origin; zeros are allowed

    Returns
    -------
    sites : (m, 3) float array; fewer than `count` if no lattice has as many, then those of the one with the most
    spacing : float, the distance of neighbours, at least `distance` (up to rounding, where they fit exactly)
    """
    choices = [(lattice, list(axes)) for lattice in LATTICES for axes in permutations(range(3))]
    spacings = [_widest(lattice, sides[axes] / distance, count) for lattice, axes in choices]
    if not any(spacings):
        spacings = [float(_count(lattice, sides[axes] / distance)) for lattice, axes in choices]
        spacing = 1.0
    else:
        spacing = max(spacings)
    lattice, axes = choices[int(np.argmax(spacings))]
    found = _stretched(lattice, sides[axes], spacing * distance)
    # The spacing without the allowance for rounding, so that spheres displaced within it do not overlap.
    return found[:, np.argsort(axes)], max(spacing * (1 - 2 * EXACTLY), 1.0) * distance


def _widest(lattice: Lattice, sides: NDArray[np.float64], count: int) -> float:
    """The largest spacing, at least 1, with so many sites; 0 if there is none."""
    if _count(lattice, sides) < count:
        return 0.0
    low, high = 1.0, 2.0
    while _count(lattice, sides / high) >= count and high < 2 * sides.max() + 2:
        low, high = high, 2 * high
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if _count(lattice, sides / middle) >= count else (low, middle)
    return low


def _count(lattice: Lattice, sides: NDArray[np.float64]) -> int:
    """How many sites of spacing 1 are in a box."""
    count = 0
    for layer, row in product(range(2), range(2)):
        x, y = lattice.lines(layer, row)
        of_row = _steps(sides[0] - x, 1.0) * _steps(sides[1] - y, 2 * lattice.row)
        count += of_row * _steps(sides[2] - layer * lattice.layer, 2 * lattice.layer)
    return count


def _stretched(lattice: Lattice, sides: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """The sites in a box, drawn apart along each axis until they reach its walls."""
    scaled = sides / spacing
    parts = []
    for layer, row in product(range(2), range(2)):
        x, y = lattice.lines(layer, row)
        z = layer * lattice.layer
        axes = [
            start + pitch * np.arange(_steps(side - start, pitch))
            for start, pitch, side in zip((x, y, z), (1.0, 2 * lattice.row, 2 * lattice.layer), scaled, strict=True)
        ]
        parts.append(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))
    found = np.concatenate(parts)
    reach = found.max(axis=0)
    stretch = np.divide(sides, reach, out=np.zeros(3), where=reach > 0)
    return np.asarray((found - reach / 2) * stretch)


def _steps(side: float, pitch: float) -> int:
    """How many sites a pitch apart fit along a side, the first at its wall."""
    return int(np.floor(side / pitch + EXACTLY)) + 1 if side >= -EXACTLY else 0
