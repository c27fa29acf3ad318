"""One scene: a shape, the meshes, the bodies that have them, and the box around them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import Hull
from harness.scene.mesh import NO_HULL, Mesh, Surface
from harness.scene.recorded_poses import RecordedPoses
from harness.vocabulary import Shape

Solid = tuple[int, float]
"""What bodies share that have the same solid: the number of their mesh, and their size, m."""


def by_solid(hulls: Mapping[Solid, Hull] | Mapping[float, Hull]) -> dict[Solid, Hull]:
    """Hulls by what bodies share, of hulls that may be given by size (m) alone, which is enough of one mesh."""
    return {solid if isinstance(solid, tuple) else (0, solid): hull for solid, hull in hulls.items()}


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything a run starts from.

    Parameters
    ----------
    shape : what the narrow phase sees of a body
    meshes : the meshes that there are, each once; none only for spheres
    bodies : as they are at time 0
    box : closed, centred at the origin
    hulls : by what bodies share, its hull in m, where it replaces that of the mesh: in a comparison every backend then
        gets the hull that one of them has made
    mesh_of : (n,) int array, the number of each body's mesh; all have the first if it is left out
    ignored : (k, 2) int array, pairs i < j that are never asked about, sorted, each once
    poses : of the centres, where they were recorded; the box is then only known to hold them
    apart : whether the bodies were placed so that no two bounding spheres overlap
    """

    shape: Shape
    meshes: tuple[Mesh, ...]
    bodies: Bodies
    box: Box
    hulls: Mapping[Solid, Hull] = field(default_factory=dict)
    mesh_of: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    ignored: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 2), np.int64))
    poses: RecordedPoses | None = None
    apart: bool = False

    def __post_init__(self) -> None:
        if not self.meshes and self.shape != "sphere":
            raise ValueError(f"shape {self.shape} needs a mesh")
        for mesh in self.meshes if self.shape == "hull" else ():
            if mesh.flat:
                raise InputError(f"{mesh.name}: {NO_HULL}")
        shared = len(self.meshes) < 2 or not len(self.mesh_of)
        numbers = np.zeros(len(self.bodies), np.int64) if shared else np.array(self.mesh_of, np.int64)
        if len(numbers) != len(self.bodies) or (numbers >= max(1, len(self.meshes))).any():
            raise ValueError("each body has a mesh, one of those that there are")
        object.__setattr__(self, "mesh_of", numbers)
        object.__setattr__(self, "hulls", by_solid(self.hulls))

    @property
    def mesh(self) -> Mesh | None:
        """The mesh that all bodies share; None only for spheres.

        Raises
        ------
        InputError
            If there are several: who asks for the one mesh cannot hold this scene.
        """
        if len(self.meshes) > 1:
            raise InputError(f"it holds one mesh for all bodies, and this scene has {len(self.meshes)}")
        return self.meshes[0] if self.meshes else None

    @property
    def solids(self) -> list[Solid]:
        """What each body shares with others that have the same solid, in the order of the bodies."""
        return list(zip(self.mesh_of.tolist(), self.bodies.sizes.tolist(), strict=True))

    def solid_of(self, size: float, mesh: int | None = None) -> Surface:
        """What stands for a body of this size (m) in the narrow phase, in m, in its own frame: its hull or its mesh.

        Parameters
        ----------
        size : m
        mesh : its number; it may be left out where all bodies share one

        Raises
        ------
        ValueError
            For spheres, which have neither vertices nor faces.
        InputError
            If there are several meshes, and none is named.
        """
        if mesh is None:
            _ = self.mesh  # refuses several
            mesh = 0
        if not self.meshes or self.shape == "sphere":
            raise ValueError("a sphere has no vertices")
        if self.shape == "hull" and (mesh, size) in self.hulls:
            hull = self.hulls[mesh, size]
            return Surface(hull.vertices, hull.faces)
        solid = self.meshes[mesh].hull if self.shape == "hull" else self.meshes[mesh]
        return Surface(solid.vertices * size, solid.faces)

    def solid_of_body(self, body: int) -> Surface:
        """What stands for a body in the narrow phase, as `solid_of`."""
        return self.solid_of(float(self.bodies.sizes[body]), int(self.mesh_of[body]))

    @property
    def enclosing_radii(self) -> NDArray[np.float64]:
        """(n,) m: radii of spheres around the centres that hold the bodies.

        Those of the bounding spheres; a hull that is given in place of the mesh's own may stick out of them.
        """
        radii: NDArray[np.float64] = self.bodies.radii.copy()
        for (mesh, size), hull in self.hulls.items():
            reach = float(np.linalg.norm(hull.vertices, axis=1).max())
            like = (self.bodies.sizes == size) & (self.mesh_of == mesh)
            radii[like] = np.maximum(radii[like], reach)
        return radii

    @property
    def faces(self) -> float:
        """Faces of a mesh; the mean over the bodies if there are several, and 0 without one."""
        return self._mean_over_bodies([len(mesh.faces) for mesh in self.meshes])

    @property
    def hull_vertices(self) -> float:
        """Vertices of a mesh's convex hull; the mean over the bodies if there are several, and 0 without one."""
        return self._mean_over_bodies([len(mesh.hull.vertices) for mesh in self.meshes])

    @property
    def packing(self) -> float:
        """Volume of all bounding spheres over the volume of the box."""
        return float(np.pi / 6 * np.sum(self.bodies.sizes**3) / self.box.volume)

    @property
    def box_side(self) -> float:
        """m. Of a box with unequal sides, the side of the cube of the same volume."""
        return float(np.cbrt(self.box.volume))

    @property
    def pair_count(self) -> int:
        """Of pairs that are asked about: all but the ignored."""
        return len(self.bodies) * (len(self.bodies) - 1) // 2 - len(self.ignored)

    @property
    def mean_size(self) -> float:
        """m. Mean diameter of the bounding spheres; 0 without bodies."""
        return float(self.bodies.sizes.mean()) if len(self.bodies) else 0.0

    def _mean_over_bodies(self, of_mesh: Sequence[int]) -> float:
        if len(of_mesh) < 2 or not len(self.bodies):
            return of_mesh[0] if of_mesh else 0
        return float(np.asarray(of_mesh)[self.mesh_of].mean())
