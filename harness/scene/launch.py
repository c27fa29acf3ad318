"""Where bodies start and which way they face: placement in the box, directions and orientations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.scene.box import Box
from harness.scene.lattice import sites
from harness.scene.random_packing import SATURATION, add_at_random
from harness.scene.relaxation import overlapping, relaxed

# No packing of equal spheres, in a box or without one, is denser (Kepler's conjecture; Hales 2005).
DENSEST = float(np.pi / np.sqrt(18))
JAMMING = 0.64  # equal spheres in disorder are no denser (Bernal and Mason 1960)
# Up to FEW bodies it is cheap to try what works in small boxes only; above MANY the last way may take minutes.
FEW, MANY = 1000, 5000
SMALLER = "lower size or enlarge the box"
ADVICE = "lower count or box_ratio, or set overlap: allow"


class PlacementError(Exception):
    """The bodies cannot be placed in their box, or no way to was found."""


def place(radii: NDArray[np.float64], box: Box, rng: np.random.Generator, overlap: bool) -> NDArray[np.float64]:
    """Random centres of bounding spheres inside a box.

    At random one after another if that succeeds; else on a lattice, at a random choice of its sites, each displaced at
    random as far as its neighbours allow; else anywhere and then pushed apart.

    Parameters
    ----------
    radii : (n,) float array, m
    box : Box
    rng : the source of all randomness; the same state gives the same centres
    overlap : whether spheres may overlap

    Returns
    -------
    (n, 3) float array, m
        Every sphere is inside the box and, unless `overlap`, no two overlap; they may touch (both up to rounding).

    Raises
    ------
    PlacementError
        If that is impossible or no way was found: says how far it got and what to change.
    """
    radii = np.asarray(radii, np.float64)
    if len(radii) == 0:
        return np.empty((0, 3))
    largest = float(radii.max())
    if largest > box.half.min():
        raise PlacementError(f"a body of diameter {2 * largest:g} m does not fit in a box of {_sides(box)}; {SMALLER}")
    if overlap:
        return (2 * rng.random((len(radii), 3)) - 1) * (box.half - radii[:, None])
    _refuse_impossible(radii, box)

    most = 0
    for way in (_at_random, _on_lattice, _pushed_apart):
        positions = way(radii, box, rng)
        if len(positions) == len(radii):
            return positions
        most = max(most, len(positions))
    reached, asked = _packing(np.sort(radii)[len(radii) - most :], box), _packing(radii, box)
    raise PlacementError(
        f"only {most} of {len(radii)} bodies could be placed without overlap in a box of {_sides(box)} "
        f"(packing {reached:.3f} of {asked:.3f}); {ADVICE}"
    )


def directions(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """(n, 3) float array: unit vectors, uniform on the sphere."""
    height, angle = 2 * rng.random(n) - 1, 2 * np.pi * rng.random(n)
    across = np.sqrt((1 - height) * (1 + height))
    return np.column_stack([across * np.cos(angle), across * np.sin(angle), height])


def orientations(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """(n, 4) float array: unit quaternions w x y z, uniform over all rotations (Shoemake 1992)."""
    share, one, two = rng.random(n), 2 * np.pi * rng.random(n), 2 * np.pi * rng.random(n)
    a, b = np.sqrt(1 - share), np.sqrt(share)
    return np.column_stack([b * np.cos(two), a * np.sin(one), a * np.cos(one), b * np.sin(two)])


def _refuse_impossible(radii: NDArray[np.float64], box: Box) -> None:
    """Raise for bodies that no placement can fit, as far as a quick test can tell."""
    packing = _packing(radii, box)
    if packing > 1:
        raise PlacementError(
            f"{len(radii)} bodies have {packing:.3g} times the volume of their box of {_sides(box)}; {ADVICE}"
        )
    if radii.min() == radii.max() and packing > DENSEST * (1 + 1e-9):
        raise PlacementError(
            f"{len(radii)} bodies of equal size would fill {packing:.3f} of a box of {_sides(box)}; "
            f"equal spheres fill at most {DENSEST:.3f}; {ADVICE}"
        )
    if len(radii) > 1:
        one, two = np.partition(radii, -2)[-2:]
        if np.linalg.norm(2 * box.half - one - two) < (one + two) * (1 - 1e-12):
            raise PlacementError(
                f"the two largest bodies, of diameters {2 * two:g} and {2 * one:g} m, overlap wherever they are "
                f"in a box of {_sides(box)}; {ADVICE}"
            )


def _at_random(radii: NDArray[np.float64], box: Box, rng: np.random.Generator) -> NDArray[np.float64]:
    """One after another, largest first: where as many of the largest as found room are; all, in order, if all did."""
    too_dense = radii.min() == radii.max() and _packing(radii, box) > SATURATION
    if too_dense and len(radii) > FEW:
        return np.empty((0, 3))
    order = np.argsort(-radii, kind="stable")
    found = add_at_random(radii[order], box.half, rng)
    if len(found) < len(radii):
        return found
    positions = np.empty_like(found)
    positions[order] = found
    return positions


def _on_lattice(radii: NDArray[np.float64], box: Box, rng: np.random.Generator) -> NDArray[np.float64]:
    """Random lattice sites, as far apart as the largest bodies need, each displaced as far as its neighbours allow."""
    radius = float(radii.max())
    inner = np.maximum(box.half - radius, 0)
    places, spacing = sites(len(radii), 2 * radius, 2 * inner)
    chosen = places[rng.permutation(len(places))[: len(radii)]]
    slack = max(spacing / 2 - radius, 0) * (1 - 1e-9)
    displaced = chosen + directions(rng, len(chosen)) * slack * np.cbrt(rng.random((len(chosen), 1)))
    # Back into the box: a site is in it, and what is nearest to a point in a convex set is no further from the site.
    return np.clip(displaced, -inner, inner)


def _pushed_apart(radii: NDArray[np.float64], box: Box, rng: np.random.Generator) -> NDArray[np.float64]:
    """Anywhere, then pushed apart; none if some still overlap, or if that is too slow or too dense to try."""
    too_dense = radii.min() == radii.max() and _packing(radii, box) > JAMMING
    if too_dense or len(radii) > MANY:
        return np.empty((0, 3))
    positions = relaxed(radii, box.half, rng)
    return np.empty((0, 3)) if len(overlapping(positions, radii)) else positions


def _packing(radii: NDArray[np.float64], box: Box) -> float:
    """Volume of spheres over the volume of the box."""
    return float(4 / 3 * np.pi * np.sum(radii**3) / box.volume)


def _sides(box: Box) -> str:
    return " x ".join(f"{side:g}" for side in box.sides) + " m"
