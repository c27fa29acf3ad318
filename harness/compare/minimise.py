"""The smallest scene in which a backend is still wrong: as few bodies, and numbers as round, as still show it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial

import numpy as np

from harness.arrays import Floats
from harness.compare.comparison import Asked, disagreements
from harness.compare.isolated import UnusableError
from harness.compare.outcome import Case
from harness.compare.poses import Frame, Pose
from harness.scene.bodies import Bodies
from harness.scene.scene import Scene

# Digits after the point that coordinates are rounded to, from the roundest.
_DIGITS = (0, 1, 2, 3, 4, 6, 9, 12)


def minimise(case: Case, known: Case | None = None) -> Case | None:
    """The same backend wrong in a scene of its own, with its bodies at rest at their poses, or in a frame of their own.

    Bodies are taken away, first by halves, then one by one, as long as the backend is still wrong about any that are
    left; then coordinates, orientations and sizes are rounded as far as that goes.

    Parameters
    ----------
    case : Case
    known : what was made of the same wrong verdict beside another backend; taken where it shows this one as well

    Returns
    -------
    Case or None
        None if the scene does not show it when asked once: it may depend on what was asked before.
    """
    if known is not None and (same := _wrong_again(case, replace(known.scene, hulls={}))) is not None:
        return same
    small = _wrong_again(case, _alone(case.scene, case.pose, list(case.bodies)))
    if small is None:
        small = _with_fewer_bodies(case)
    return None if small is None else _rounded(case, small)


def _rounded(case: Case, small: Case) -> Case:
    """The roundest case: with backends that stay loaded, and where that is not found again afresh, without."""
    with _Again(case) as asked:
        found = _Rounding(small, asked.find).result()
    return _wrong_again(case, replace(found.scene, hulls={})) or _Rounding(small, partial(_wrong_again, case)).result()


def _with_fewer_bodies(case: Case) -> Case | None:
    chosen = list(range(len(case.scene.bodies)))
    small = _wrong_again(case, _alone(case.scene, case.pose, chosen))
    if small is None:
        return None
    length = len(chosen) // 2
    while length:
        before, place = len(chosen), 0
        while place < len(chosen):
            rest = chosen[:place] + chosen[place + length :]
            found = _wrong_again(case, _alone(case.scene, case.pose, rest)) if len(rest) > 1 else None
            if found is None:
                place += length
            else:
                chosen, small = rest, found
        if length > 1 or len(chosen) == before:
            length //= 2
    return small


class _Again:
    """Asks about scenes that differ in poses alone without loading the backends anew. A context.

    Parameters
    ----------
    case : what is to be found again
    """

    def __init__(self, case: Case) -> None:
        self._case = case
        self._loaded, self._sizes = ExitStack(), np.empty(0)

    def __enter__(self) -> _Again:
        return self

    def __exit__(self, *ending: object) -> None:
        self._loaded.close()

    def find(self, scene: Scene) -> Case | None:
        """The first verdict in this scene that is wrong in the same way, if there is one."""
        bodies = scene.bodies
        try:
            if not np.array_equal(self._sizes, bodies.sizes):
                self._loaded.close()
                self._asked = self._loaded.enter_context(Asked(scene, self._case.backends, self._case.question))
                self._sizes = bodies.sizes.copy()
            found = _same(self._case, self._asked.disagreements(_pose_of(self._case, scene)))
        except UnusableError:
            return None
        return None if found is None else replace(found, scene=replace(found.scene, bodies=bodies))


class _Rounding:
    """Rounds the numbers of a case as long as the backend stays wrong.

    Parameters
    ----------
    small : Case
    again : the same wrong verdict in another scene, if it is there
    """

    def __init__(self, small: Case, again: Callable[[Scene], Case | None]) -> None:
        self._small, self._again = small, again

    def result(self) -> Case:
        """The roundest case found."""
        bodies = self._bodies
        self._try(positions=bodies.positions - bodies.positions[0])
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (len(bodies), 1))
        if not self._try(quaternions=upright):
            for body in range(len(bodies)):
                self._try(quaternions=np.where(np.arange(len(bodies))[:, None] == body, upright, self._turns))
        for name in ("sizes", "quaternions", "velocities", "spins", "positions"):
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
        values: Floats = getattr(self._bodies, name)
        if not values.any():
            return  # of bodies at rest
        for digits in _DIGITS:
            if self._try(**{name: values.round(digits)}):
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
        found = self._again(replace(scene, bodies=bodies, hulls={}))
        if found is not None:
            self._small = found
        return found is not None


def _wrong_again(case: Case, scene: Scene) -> Case | None:
    """The first verdict in this scene that is wrong in the same way, if there is one."""
    try:
        found = disagreements(scene, _pose_of(case, scene), case.backends, case.question)
    except UnusableError:
        return None
    return _same(case, found)


def _same(case: Case, found: Sequence[Case]) -> Case | None:
    return next((one for one in found if one.wrong == case.wrong), None)


def _alone(scene: Scene, pose: Pose, chosen: list[int]) -> Scene:
    """Some of the bodies: at rest at their poses, or moving as they do in the frame."""
    bodies, still = scene.bodies, np.zeros((len(chosen), 3))
    velocities, spins = (pose.velocities[chosen], pose.spins[chosen]) if isinstance(pose, Frame) else (still, still)
    alone = Bodies(
        pose.positions[chosen], velocities, pose.quaternions[chosen], spins, bodies.sizes[chosen], bodies.masses[chosen]
    )
    places = {body: place for place, body in enumerate(chosen)}
    ignored = [(places[i], places[j]) for i, j in scene.ignored.tolist() if i in places and j in places]
    pairs = np.array(ignored, np.int64).reshape(-1, 2)
    return replace(scene, bodies=alone, hulls={}, poses=None, mesh_of=scene.mesh_of[chosen], ignored=pairs)


def _pose_of(case: Case, scene: Scene) -> Pose:
    """What is asked about a scene of few bodies: a frame as long as the one of the case, or the bodies at rest."""
    bodies = scene.bodies
    if isinstance(case.pose, Frame):
        motion = bodies.velocities, bodies.spins, case.pose.duration
        return Frame("frame 1", bodies.positions, bodies.quaternions, *motion, number=1)
    return Pose("at rest", bodies.positions, bodies.quaternions)
