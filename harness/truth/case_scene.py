"""A case of a set as engines and backends take it: bodies for the kernels, or a scene of two bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.backends.poses import UniformMotion
from harness.pair.body import Body
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.truth.cases import Cases
from harness.truth.engine_mesh import engine_mesh
from harness.truth.folder import TruthSet
from harness.truth.solids import Solid
from harness.vocabulary import Shape

_FARTHEST = 1e9  # m: half a side of the box, which nothing of a case reaches or asks about


class Kind(NamedTuple):
    """What two bodies are: cases that are alike in it are asked of the same scene.

    Attributes
    ----------
    solids : numbers of both
    sizes : m, of both
    """

    solids: tuple[int, int]
    sizes: tuple[float, float]


class CaseScenes:
    """The bodies of a set.

    Parameters
    ----------
    given : TruthSet
    """

    def __init__(self, given: TruthSet) -> None:
        self._cases: Cases = given.cases
        self._solids: list[Solid] = given.solids.all
        self._meshes: dict[int, Mesh] = {}

    def kind(self, row: int) -> Kind:
        """What the bodies of a case are."""
        sides = self._cases.first, self._cases.second
        first, second = ((int(side.meshes[row]), float(side.sizes[row])) for side in sides)
        return Kind((first[0], second[0]), (first[1], second[1]))

    def shape(self, row: int) -> Shape:
        """Of both bodies of a case."""
        return self._solids[int(self._cases.first.meshes[row])].shape

    def motion(self, row: int) -> UniformMotion:
        """How the two bodies of a case move, in its window; with unit quaternions."""
        sides = self._cases.first, self._cases.second
        positions, quaternions, velocities, spins = (
            np.array([column[row] for column in columns])
            for columns in (
                [side.positions for side in sides],
                [side.quaternions for side in sides],
                [side.velocities for side in sides],
                [side.spins for side in sides],
            )
        )
        quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
        return UniformMotion(positions, quaternions, velocities, spins, float(self._cases.windows[row]))

    def bodies(self, row: int, time: float = 0.0) -> tuple[Body, Body]:
        """Both bodies of a case, as they are at a time, s."""
        motion, kind, shape = self.motion(row), self.kind(row), self.shape(row)
        positions, quaternions = motion.at(time)
        first, second = (
            Body(
                self._mesh(kind.solids[k]),
                positions[k],
                quaternions[k],
                kind.sizes[k],
                motion.velocities[k],
                motion.spins[k],
                shape,
            )
            for k in (0, 1)
        )
        return first, second

    def scene(self, row: int) -> Scene:
        """A scene of the two bodies of a case."""
        motion, kind, shape = self.motion(row), self.kind(row), self.shape(row)
        bodies = Bodies(
            motion.positions, motion.velocities, motion.quaternions, motion.spins, np.array(kind.sizes), np.ones(2)
        )
        solids = list(dict.fromkeys(kind.solids))
        meshes = [mesh for mesh in map(self._mesh, solids) if mesh is not None]
        numbers = np.array([solids.index(solid) for solid in kind.solids])
        return Scene(shape, tuple(meshes), bodies, Box(np.full(3, _FARTHEST)), mesh_of=numbers)

    def _mesh(self, solid: int) -> Mesh | None:
        if self._solids[solid].shape == "sphere":
            return None
        if solid not in self._meshes:
            self._meshes[solid] = engine_mesh(self._solids[solid].mesh, self._solids[solid].surface)
        return self._meshes[solid]
