"""How far bodies can get: bounds from speeds and energy that hold whatever they hit, so that a test can be left out.

A wall and a hit of response `reflect` keep every speed. Elastic hits keep the energy or take some of it, so that no
body is ever faster than if it had all of it: v <= sqrt(2 E / m).
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.scene.scene import Scene
from harness.vocabulary import Response

# Relative room for rounding: of poses, of the energy, and of vertices that stick out of their bounding sphere.
SLACK = 1e-9
# Up to so many bodies every pair is tested.
FEW = 300


def no_pair_can_meet(scene: Scene, duration: float, within: float = 0.0) -> bool:
    """Whether it is certain that no two bounding spheres will touch, or come within a gap.

    Until two of them do, every speed stays what it is, so that body i stays within |v_i| `duration` of its start. Where
    these reachable spheres are disjoint, no pair can meet. Where their volumes together exceed that of all that they
    can reach, they cannot all be disjoint, and no pairs are searched.

    Parameters
    ----------
    scene : Scene
    duration : s
    within : m, the gap

    Returns
    -------
    bool
    """
    bodies = scene.bodies
    reach = (bodies.radii + 0.5 * within + np.linalg.norm(bodies.velocities, axis=1) * duration) * (1.0 + SLACK)
    if not np.isfinite(reach).all() or (bodies.radii >= scene.box.half.min()).any():
        return False  # a path without room in the box is no straight line
    volume = np.prod(2.0 * (scene.box.half + reach.max()))
    if 4.0 / 3.0 * np.pi * np.sum(reach**3) > volume:
        return False
    if len(bodies) <= FEW:
        return not _any_close(bodies.positions, reach)
    return not len(HierarchicalGrid(reach, scene.box).close_pairs(bodies.positions))


def _any_close(positions: Floats, radii: Floats) -> bool:
    """Whether any two spheres touch; of few, every pair is tested, without the kernel of a grid, which takes longer."""
    gaps, touch = positions[:, None] - positions, radii[:, None] + radii
    squares = gaps[..., 0] * gaps[..., 0] + gaps[..., 1] * gaps[..., 1] + gaps[..., 2] * gaps[..., 2]
    return bool(np.triu(squares <= touch * touch, 1).any())


def walls_are_out_of_reach(scene: Scene, duration: float, response: Response, *, no_pairs: bool) -> bool:
    """Whether it is certain that no bounding sphere will touch a wall.

    Parameters
    ----------
    scene : Scene
    duration : s
    response : {"reflect", "elastic"}
    no_pairs : whether no two bodies meet, so that every one flies straight
    """
    bodies = scene.bodies
    speeds = np.abs(bodies.velocities) if no_pairs else fastest(scene, response)[:, None]
    farthest = np.abs(bodies.positions) + bodies.radii[:, None] + speeds * duration
    return bool((farthest * (1.0 + SLACK) < scene.box.half).all())


def fastest(scene: Scene, response: Response) -> Floats:
    """(n,) m/s: a speed that each body never exceeds."""
    bodies = scene.bodies
    if response == "elastic":
        # not by the kernel that measures the energy of a run: a plan would wait for numba, and this is only a bound
        with np.errstate(over="ignore"):
            twice_energy = np.sum(bodies.masses * np.sum(bodies.velocities**2, axis=1))
            bound: Floats = np.sqrt(twice_energy / bodies.masses)
    else:
        bound = np.linalg.norm(bodies.velocities, axis=1)
    return bound * (1.0 + SLACK)


def all_at_rest(scene: Scene) -> bool:
    """Whether every body rests and keeps its orientation, so that every frame looks the same."""
    bodies = scene.bodies
    return not bodies.velocities.any() and (scene.shape == "sphere" or not bodies.spins.any())
