"""A case of a set as engines and backends take it: bodies for the kernels, or a scene of two bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, cast

import numpy as np

from harness.arrays import Floats
from harness.backends.poses import Motion
from harness.errors import InputError
from harness.pair.body import Body
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.mesh import Mesh, Surface
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

    def motion(self, row: int) -> Motion:
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
        return Motion(positions, quaternions, velocities, spins, float(self._cases.windows[row]))

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
        sizes = kind.sizes
        if kind.solids[0] != kind.solids[1] and sizes[0] == sizes[1]:
            # a backend tells bodies apart by their sizes; what it gets for this one has the true size
            sizes = sizes[0], float(np.nextafter(sizes[1], np.inf))
        bodies = Bodies(
            motion.positions, motion.velocities, motion.quaternions, motion.spins, np.array(sizes), np.ones(2)
        )
        box = Box(np.full(3, _FARTHEST))
        if shape == "sphere":
            return Scene(shape, None, bodies, box)
        surfaces = [self._solids[solid].surface for solid in kind.solids]
        solids = {
            label: Surface(surface.vertices * size, surface.faces)
            for label, surface, size in zip(sizes, surfaces, kind.sizes, strict=True)
        }
        alike = kind.solids[0] == kind.solids[1]
        mesh = self._mesh(kind.solids[0]) if alike else cast(Mesh, _NoCommonMesh())
        return _PairScene(shape, mesh, bodies, box, solids=solids)

    def _mesh(self, solid: int) -> Mesh | None:
        if self._solids[solid].shape == "sphere":
            return None
        if solid not in self._meshes:
            self._meshes[solid] = engine_mesh(self._solids[solid].mesh, self._solids[solid].surface)
        return self._meshes[solid]


@dataclass(frozen=True, eq=False)
class _PairScene(Scene):
    """A scene whose two bodies may have meshes of their own, of any unit.

    Parameters
    ----------
    solids : by the size of a body, m: its hull or its mesh, in m
    """

    solids: Mapping[float, Surface] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Nothing is to be checked: the set has been read."""

    def solid_of(self, size: float) -> Surface:
        return self.solids[size]

    @property
    def enclosing_radii(self) -> Floats:
        reach = [np.linalg.norm(self.solids[size].vertices, axis=1).max() for size in self.bodies.sizes.tolist()]
        return np.maximum(self.bodies.radii, reach)


class _NoCommonMesh:
    """Stands where a scene has the mesh of all its bodies; a backend that looks into it would answer for other bodies.

    Raises
    ------
    InputError
        For whatever it is asked.
    """

    flat = False  # `scene` makes hulls of solids alone

    def __getattr__(self, name: str) -> Any:
        raise InputError("it takes both bodies to have the same mesh")
