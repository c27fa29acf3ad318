"""trimesh's CollisionManager: FCL behind a tree of its own making, with a geometry for every body.

It has no spheres. A mesh that it takes for convex it holds as a solid, so that one inside another is a hit.
"""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation
from trimesh.collision import CollisionManager

from harness.arrays import Floats, Pairs
from harness.backends.fcl_objects import MISSED_BY_UNLIKE, MOST_UNLIKE, UNITS, fcl_unit, size_ratio
from harness.errors import InputError
from harness.scene.mesh import has_area
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Shape


class Trimesh:
    """Poses set one by one, then all pairs that the manager finds in collision."""

    name = "trimesh"
    shapes: tuple[Shape, ...] = ("hull", "mesh")
    units = UNITS
    precision = "double"
    solid: tuple[Shape, ...] = ("mesh",)
    _size_ratio = 1.0

    def tolerance(self, shape: Shape) -> float:
        """FCL's own, since that is what it asks: the rare worst case for hulls, rounding for meshes."""
        if shape == "hull" and self._size_ratio > MOST_UNLIKE:
            return MISSED_BY_UNLIKE
        return {"hull": 1e-11, "mesh": 1e-14}.get(shape, 0.0)

    def load(self, scene: Scene) -> None:
        """Raises InputError for a hull that trimesh does not take for convex: it would hold its surface only."""
        self._unit = fcl_unit(scene.bodies.sizes)
        self._size_ratio = size_ratio(scene.bodies.sizes)
        self._manager = CollisionManager()
        solids: dict[Solid, trimesh.Trimesh] = {}
        for body, solid in enumerate(scene.solids):
            if solid not in solids:
                surface = scene.solid_of_body(body)
                faces = surface.faces[has_area(*surface)] if scene.shape == "mesh" else surface.faces
                solids[solid] = trimesh.Trimesh(surface.vertices / self._unit, faces, process=False)
                if scene.shape == "hull" and not solids[solid].is_convex:
                    raise InputError("it does not take this hull for convex, and would hold its surface only")
            self._manager.add_object(body, solids[solid])

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        if not (np.isfinite(positions).all() and np.isfinite(quaternions).all()):
            raise ValueError("a pose is not finite")
        poses = np.tile(np.eye(4), (len(positions), 1, 1))
        poses[:, :3, :3] = Rotation.from_quat(quaternions[:, [1, 2, 3, 0]]).as_matrix()
        poses[:, :3, 3] = positions / self._unit
        for body, pose in enumerate(poses):
            self._manager.set_transform(body, pose)
        _, touching = self._manager.in_collision_internal(return_names=True)
        return np.array(sorted(touching), np.int64).reshape(-1, 2)


BACKEND = Trimesh
