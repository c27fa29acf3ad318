"""Random sequential addition: spheres are put at random places, one after another, where no earlier one is in the way.

Largest first: a small sphere finds a hole between large ones, not the other way about.
"""

from __future__ import annotations

import math

import numpy as np

from harness.arrays import Floats
from harness.kernel import kernel
from harness.scene.placed_spheres import PlacedSpheres, is_free, none_placed, not_taken, place_of, put

# Up to so many spheres, and up to this packing, are placed without a kernel, which would take longer to load.
FEW, LOOSE = 1000, 0.3
# Tries for each sphere, on the average. A million equal spheres take forty up to a packing of .30.
TRIES = 50
# Draws whose cells are read into the caches together, before they are looked at one by one.
TOGETHER = 64
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
    placed = none_placed(radii, half)

    done, tries = 0, TRIES * count + 100_000
    while done < count and tries > 0:
        draws = rng.random((min(tries, max(1024, min(4 * (count - done), 1 << 18))), 3))
        done = (_add_few if count <= FEW and loose else _add)(done, placed, draws)
        tries -= len(draws)
    return np.array(placed.spheres["position"][:done])


def _add_few(done: int, placed: PlacedSpheres, draws: Floats) -> int:
    """As `_add`, to the bit: some draws at once against all spheres that are placed, more where few are free."""
    positions, radii, half = placed.spheres["position"], placed.radii, placed.half
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


# Draws, the fewest and the most: one in twelve is free in a fluid of packing .3.
_AT_ONCE = (16, 256)


@kernel
def _add(done: int, placed: PlacedSpheres, draws: Floats) -> int:
    """Place spheres from `done` on with (m, 3) uniform draws until either are used up; returns how many are placed."""
    left, near = np.empty(TOGETHER, np.int64), np.empty(27, np.int32)
    for begin in range(0, len(draws), TOGETHER):
        if done == len(placed.radii):
            break
        some = draws[begin : begin + TOGETHER]
        for k in left[: not_taken(placed, done, some, left)]:
            if done == len(placed.radii):
                break
            place = place_of(placed, some[k], placed.radii[done])
            if is_free(placed, done, place, near):
                put(placed, done, place)
                done += 1
    return done
