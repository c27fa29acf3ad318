"""What makes a motion ill-posed, as its start tells: bodies inside one another, or no room between walls.

A run of such a motion comes to an end, but methods do not agree on it, and none of them is wrong.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Pairs
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.broadphase.ignored import asked_about
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from harness.vocabulary import ILL_POSED

# Of the distance of two centres that touch: what is nearer overlaps, what is farther has room; placing rounds by less.
ROUNDING = 1e-9
# Bodies placed apart can have no room from here on: a cubic lattice has .52.
DENSE = 0.45
# Up to so many bodies every pair is tested, without the kernel of a grid, which takes longer to load.
FEW = 1000


def ill_posed(scene: Scene, law: MotionLaw) -> tuple[str, ...]:
    """A sentence on each way in which a motion is ill-posed, none where nothing moves or nothing answers a hit."""
    if law.response == "none" or scene.poses is not None or not scene.bodies.velocities.any():
        return ()
    sphere = scene.shape == "sphere"
    pairs = np.empty((0, 2), np.int64)
    if not scene.apart or (sphere and scene.packing >= DENSE):
        pairs = _near_pairs(scene)
    bodies = scene.bodies
    reach = bodies.radii[pairs[:, 0]] + bodies.radii[pairs[:, 1]]
    gaps = bodies.positions[pairs[:, 1]] - bodies.positions[pairs[:, 0]]
    inside = np.linalg.norm(gaps, axis=1) < reach * (1.0 - ROUNDING)
    found = []
    if count := int(np.count_nonzero(inside)):
        pair, them = ("1 pair", "begins") if count == 1 else (f"{count} pairs", "begin")
        if sphere:
            found.append(f"{pair} of bodies {them} inside one another: such a motion is {ILL_POSED}")
        else:
            spheres = f"the bounding spheres of {pair} of bodies overlap at the start"
            found.append(f"{spheres}: if the bodies in them do, too, the motion is {ILL_POSED}")
    if sphere:
        axes = [name for axis, name in enumerate("xyz") if _full_along(scene, pairs[~inside], axis)]
        if axes:
            found.append(f"bodies have no room along {' and '.join(axes)}, from wall to wall: this is {ILL_POSED}")
    return tuple(found)


def _near_pairs(scene: Scene) -> Pairs:
    """(k, 2): the pairs of bounding spheres that touch or overlap, but for the ignored."""
    radii, positions = scene.bodies.radii * (1.0 + ROUNDING), scene.bodies.positions
    if len(radii) > FEW:
        return np.asarray(asked_about(HierarchicalGrid(radii, scene.box), scene.ignored).close_pairs(positions))
    near = np.linalg.norm(positions[:, None] - positions, axis=2) <= radii[:, None] + radii
    if len(scene.ignored):
        near[scene.ignored[:, 0], scene.ignored[:, 1]] = False
    return np.argwhere(np.triu(near, 1))


def _full_along(scene: Scene, pairs: Pairs, axis: int) -> bool:
    """Whether bodies that touch one another stand in line from wall to wall; pairs (k, 2) are those that touch."""
    bodies, half = scene.bodies, scene.box.half[axis]
    place, radii = bodies.positions[:, axis], bodies.radii
    reached = place - radii <= -half + ROUNDING * radii
    at_end = place + radii >= half - ROUNDING * radii
    along = bodies.positions[pairs[:, 1]] - bodies.positions[pairs[:, 0]]
    length = np.linalg.norm(along, axis=1)
    in_line = pairs[np.abs(along[:, axis]) >= length * (1.0 - ROUNDING)]
    low, high = np.where(place[in_line[:, :1]] < place[in_line[:, 1:]], in_line, in_line[:, ::-1]).T
    for which in np.argsort(place[low], kind="stable"):
        reached[high[which]] |= reached[low[which]]
    return bool((reached & at_end).any())
