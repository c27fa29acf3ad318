"""The smallest scene in which two backends still disagree: as few bodies as do it, with numbers as round as do it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from harness.arrays import Floats
from harness.compare.comparison import Case, disagreements
from harness.compare.isolated import UnusableError
from harness.compare.poses import Pose
from harness.scene.bodies import Bodies
from harness.scene.scene import Scene

# Digits after the point that positions and quaternions are rounded to, from the roundest.
_DIGITS = (2, 4, 6, 9, 12)


def minimise(case: Case) -> Case | None:
    """The same backend wrong in a scene of its own, with its bodies at rest at their poses.

    Returns
    -------
    Case or None
        None if no scene of two or three bodies shows it when asked once: it then depends on what was asked before.
    """
    for chosen in _choices(case):
        small = _wrong_again(case, _at_rest(case.scene, case.pose, chosen))
        if small is not None:
            return _rounded(small)
    return None


def _choices(case: Case) -> Iterator[list[int]]:
    """The two bodies, then both with each of the others."""
    yield list(case.bodies)
    for other in range(len(case.scene.bodies)):
        if other not in case.bodies:
            yield sorted((*case.bodies, other))


def _rounded(case: Case) -> Case:
    bodies = case.scene.bodies
    for digits in _DIGITS:
        positions = (bodies.positions - bodies.positions[0]).round(digits)
        found = _wrong_again(case, _placed(case.scene, positions, bodies.quaternions.round(digits)))
        if found is not None:
            return found
    return case


def _wrong_again(case: Case, scene: Scene) -> Case | None:
    """A real disagreement in this scene that the same backend loses."""
    pose = Pose("at rest", scene.bodies.positions, scene.bodies.quaternions)
    try:
        found = disagreements(scene, pose, case.backends)
    except UnusableError:
        return None
    return next((one for one in found if one.wrong == case.wrong), None)


def _at_rest(scene: Scene, pose: Pose, chosen: list[int]) -> Scene:
    sizes, masses = scene.bodies.sizes[chosen], scene.bodies.masses[chosen]
    still = np.zeros((len(chosen), 3))
    bodies = Bodies(pose.positions[chosen], still, pose.quaternions[chosen], still, sizes, masses)
    return replace(scene, bodies=bodies, hulls={})


def _placed(scene: Scene, positions: Floats, quaternions: Floats) -> Scene:
    lengths = np.linalg.norm(quaternions, axis=1, keepdims=True)
    turned = np.where(lengths > 0, quaternions / np.where(lengths > 0, lengths, 1.0), scene.bodies.quaternions)
    return replace(scene, bodies=replace(scene.bodies, positions=positions, quaternions=turned))
