"""The smallest scene in which a backend is still wrong: as few bodies, and numbers as round, as still show it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.arrays import Floats
from harness.compare.comparison import disagreements
from harness.compare.isolated import UnusableError
from harness.compare.outcome import Case
from harness.compare.poses import Pose
from harness.scene.bodies import Bodies
from harness.scene.scene import Scene

# Digits after the point that coordinates are rounded to, from the roundest.
_DIGITS = (0, 1, 2, 3, 4, 6, 9, 12)


def minimise(case: Case) -> Case | None:
    """The same backend wrong in a scene of its own, with its bodies at rest at their poses.

    Bodies are taken away, first by halves, then one by one, as long as the backend is still wrong about any that are
    left; then coordinates, orientations and sizes are rounded as far as that goes.

    Returns
    -------
    Case or None
        None if the scene does not show it when asked once: it then depends on what was asked before.
    """
    small = _wrong_again(case, _at_rest(case.scene, case.pose, list(case.bodies)))
    if small is None:
        small = _with_fewer_bodies(case)
    return None if small is None else _Rounding(case, small).result()


def _with_fewer_bodies(case: Case) -> Case | None:
    chosen = list(range(len(case.scene.bodies)))
    small = _wrong_again(case, _at_rest(case.scene, case.pose, chosen))
    if small is None:
        return None
    length = len(chosen) // 2
    while length:
        before, place = len(chosen), 0
        while place < len(chosen):
            rest = chosen[:place] + chosen[place + length :]
            found = _wrong_again(case, _at_rest(case.scene, case.pose, rest)) if len(rest) > 1 else None
            if found is None:
                place += length
            else:
                chosen, small = rest, found
        if length > 1 or len(chosen) == before:
            length //= 2
    return small


class _Rounding:
    """Rounds the numbers of a case as long as the backend stays wrong."""

    def __init__(self, case: Case, small: Case) -> None:
        self._case, self._small = case, small

    def result(self) -> Case:
        """The roundest case found."""
        bodies = self._bodies
        self._try(positions=bodies.positions - bodies.positions[0])
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (len(bodies), 1))
        if not self._try(quaternions=upright):
            for body in range(len(bodies)):
                self._try(quaternions=np.where(np.arange(len(bodies))[:, None] == body, upright, self._turns))
        for name in ("sizes", "quaternions", "positions"):
            self._round_all(name)
        for body in range(len(bodies)):
            for axis in range(3):
                self._round_one(body, axis)
        return self._small

    @property
    def _bodies(self) -> Bodies:
        return self._small.scene.bodies

    @property
    def _turns(self) -> Floats:
        return self._bodies.quaternions

    def _round_all(self, name: str) -> None:
        for digits in _DIGITS:
            if self._try(**{name: getattr(self._bodies, name).round(digits)}):
                return

    def _round_one(self, body: int, axis: int) -> None:
        for digits in _DIGITS:
            positions = self._bodies.positions.copy()
            positions[body, axis] = round(float(positions[body, axis]), digits)
            if np.array_equal(positions, self._bodies.positions):
                return  # it is as round already
            if self._try(positions=positions):
                return

    def _try(self, **changed: Floats) -> bool:
        """Take these numbers, if the backend is wrong with them as well."""
        scene = self._small.scene
        bodies = replace(scene.bodies, **{name: values + 0.0 for name, values in changed.items()})  # no -0
        if (bodies.sizes <= 0).any() or not np.linalg.norm(bodies.quaternions, axis=1).all():
            return False
        lengths = np.linalg.norm(bodies.quaternions, axis=1, keepdims=True)
        bodies = replace(bodies, quaternions=bodies.quaternions / lengths, masses=bodies.sizes**3)
        found = _wrong_again(self._case, replace(scene, bodies=bodies, hulls={}))
        if found is not None:
            self._small = found
        return found is not None


def _wrong_again(case: Case, scene: Scene) -> Case | None:
    """The first verdict in this scene that is wrong in the same way, if there is one."""
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
    places = {body: place for place, body in enumerate(chosen)}
    ignored = [(places[i], places[j]) for i, j in scene.ignored.tolist() if i in places and j in places]
    pairs = np.array(ignored, np.int64).reshape(-1, 2)
    return replace(scene, bodies=bodies, hulls={}, mesh_of=scene.mesh_of[chosen], ignored=pairs)
