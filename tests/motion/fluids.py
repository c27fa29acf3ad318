"""Equilibrated fluids of equal elastic spheres in a cubic box, for rates and for theory."""

from __future__ import annotations

from math import ceil, pi

import numpy as np

from harness.motion.predictive.simulation import Simulation


def lattice(count: int, packing: float, seed: int = 259, diameter: float = 1.0) -> tuple[np.ndarray, float]:
    """(count, 3) FCC sites picked at random, shaken a little, and half the box side."""
    rng = np.random.default_rng(seed)
    side = diameter * (count * pi / (6.0 * packing)) ** (1 / 3)
    free = side - diameter
    cells = ceil((count / 4) ** (1 / 3))
    while True:  # sites of an FCC lattice that spans the reachable box, corners included
        grid = np.indices((2 * cells + 1,) * 3).reshape(3, -1).T
        sites = grid[grid.sum(axis=1) % 2 == 0]
        if len(sites) >= count:
            break
        cells += 1
    while cells > 1:
        fewer = np.indices((2 * (cells - 1) + 1,) * 3).reshape(3, -1).T
        fewer = fewer[fewer.sum(axis=1) % 2 == 0]
        if len(fewer) < count:
            break
        cells -= 1
        sites = fewer
    spacing = free / (2 * cells)
    gap = spacing * 2**0.5 - diameter
    if gap <= 0:
        raise ValueError(f"no FCC lattice of {count} spheres at packing {packing} in a box with walls")
    chosen = sites[rng.permutation(len(sites))[:count]] * spacing - free / 2
    chosen += rng.uniform(-0.2 * gap / 3**0.5, 0.2 * gap / 3**0.5, chosen.shape)
    return np.clip(chosen, -free / 2, free / 2), side / 2


def fluid(count: int, packing: float, seed: int = 259, melt: float = 30.0, **options) -> Simulation:
    """A fresh simulation from a configuration melted for `melt` collisions a sphere."""
    positions, half = lattice(count, packing, seed)
    velocities = np.random.default_rng(seed + 1).normal(size=(count, 3))
    velocities -= velocities.mean(axis=0)
    box = np.full(3, half)
    ones = np.ones(count)
    melting = Simulation(positions, velocities, ones / 2, ones, box, "elastic")
    while melting.counters["pair_hits"] < melt * count / 2:
        melting.advance(np.inf, max_events=max(int(count * melt / 20), 1000))
    return Simulation(melting.positions, melting.velocities, ones / 2, ones, box, "elastic", **options)
