"""One scene: a shape, its mesh, the bodies that have it, and the box around them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import Hull
from harness.scene.mesh import NO_HULL, Mesh, Surface
from harness.vocabulary import Shape


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything a run starts from.

    Parameters
    ----------
    shape : what the narrow phase sees of a body
    mesh : the mesh all bodies share; None only for spheres
    bodies : as they are at time 0
    box : closed, centred at the origin
    hulls : by the size of a body in m, its hull in m, where it replaces that of the mesh: in a comparison every backend
        then gets the hull that one of them has made
    """

    shape: Shape
    mesh: Mesh | None
    bodies: Bodies
    box: Box
    hulls: Mapping[float, Hull] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.mesh is None and self.shape != "sphere":
            raise ValueError(f"shape {self.shape} needs a mesh")
        if self.mesh is not None and self.mesh.flat and self.shape == "hull":
            raise InputError(f"{self.mesh.name}: {NO_HULL}")

    def solid_of(self, size: float) -> Surface:
        """What stands for a body of this size (m) in the narrow phase, in m, in its own frame: its hull or its mesh.

        Raises
        ------
        ValueError
            For spheres, which have neither vertices nor faces.
        """
        if self.mesh is None or self.shape == "sphere":
            raise ValueError("a sphere has no vertices")
        if self.shape == "hull" and size in self.hulls:
            hull = self.hulls[size]
            return Surface(hull.vertices, hull.faces)
        solid = self.mesh.hull if self.shape == "hull" else self.mesh
        return Surface(solid.vertices * size, solid.faces)

    @property
    def enclosing_radii(self) -> NDArray[np.float64]:
        """(n,) m: radii of spheres around the centres that hold the bodies.

        Those of the bounding spheres; a hull that is given in place of the mesh's own may stick out of them.
        """
        radii: NDArray[np.float64] = self.bodies.radii.copy()
        for size, hull in self.hulls.items():
            reach = float(np.linalg.norm(hull.vertices, axis=1).max())
            of_size = self.bodies.sizes == size
            radii[of_size] = np.maximum(radii[of_size], reach)
        return radii

    @property
    def faces(self) -> int:
        """Faces of the mesh; 0 without one."""
        return len(self.mesh.faces) if self.mesh else 0

    @property
    def hull_vertices(self) -> int:
        """Vertices of the mesh's convex hull; 0 without a mesh."""
        return len(self.mesh.hull.vertices) if self.mesh else 0

    @property
    def packing(self) -> float:
        """Volume of all bounding spheres over the volume of the box."""
        return float(np.pi / 6 * np.sum(self.bodies.sizes**3) / self.box.volume)

    @property
    def box_side(self) -> float:
        """m. Of a box with unequal sides, the side of the cube of the same volume."""
        return float(np.cbrt(self.box.volume))

    @property
    def mean_size(self) -> float:
        """m. Mean diameter of the bounding spheres; 0 without bodies."""
        return float(self.bodies.sizes.mean()) if len(self.bodies) else 0.0
