"""trimesh's CollisionManager: FCL behind a tree of its own making, with a geometry for every body.

It has no spheres. A mesh that it takes for convex it holds as a solid, so that one inside another is a hit.
"""

from __future__ import annotations

import numpy as np
import trimesh
from trimesh.collision import CollisionManager

from harness.arrays import Floats, Pairs
from harness.backends.close_spheres import close_pairs
from harness.backends.fcl_objects import UNITS, fcl_unit
from harness.backends.poses import near_pairs, near_radii, require_finite
from harness.backends.protocol import NearPairs
from harness.backends.rotations import rotations
from harness.errors import InputError
from harness.scene.mesh import has_area
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Query, Shape


class Trimesh:
    """Poses set one by one, then all pairs that the manager finds in collision.

    Of distances a manager tells only the smallest, and of one object only that to the nearest: to ask about a pair,
    each body has a manager of its own beside. The pairs are those of bounding spheres that are near, by scipy's tree,
    since the manager has no question for them.
    """

    name = "trimesh"
    shapes: tuple[Shape, ...] = ("hull", "mesh")
    queries: tuple[Query, ...] = ("collision", "tolerance", "distance")
    units = UNITS
    precision = "double"
    solid: tuple[Shape, ...] = ("mesh",)

    def tolerance(self, shape: Shape) -> float:
        """FCL's own for hulls, the rare worst case, since that is what it asks; of convex meshes it makes hulls, too.

        Beside a body 10^4 times larger FCL's test of hulls finds contacts at gaps to 1e-11 of the larger, and none when
        the two change places.
        """
        return {"hull": 1e-11, "mesh": 1e-11}.get(shape, 0.0)

    def load(self, scene: Scene) -> None:
        """Raises InputError for a hull that trimesh does not take for convex: it would hold its surface only."""
        self._unit = fcl_unit(scene.bodies.sizes)
        self._radii = scene.enclosing_radii
        self._manager = CollisionManager()
        self._single: list[CollisionManager] = []
        solids: dict[Solid, trimesh.Trimesh] = {}
        for body, solid in enumerate(scene.solids):
            if solid not in solids:
                surface = scene.solid_of_body(body)
                faces = surface.faces[has_area(*surface)] if scene.shape == "mesh" else surface.faces
                solids[solid] = trimesh.Trimesh(surface.vertices / self._unit, faces, process=False)
                if scene.shape == "hull" and not solids[solid].is_convex:
                    raise InputError("it does not take this hull for convex, and would hold its surface only")
            self._manager.add_object(body, solids[solid])
        self._solids = [solids[solid] for solid in scene.solids]

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        for body, pose in enumerate(self._poses(positions, quaternions)):
            self._manager.set_transform(body, pose)
        _, touching = self._manager.in_collision_internal(return_names=True)
        return np.array(sorted(touching), np.int64).reshape(-1, 2)

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        if not self._single:
            self._single = [CollisionManager() for _ in self._solids]
            for body, solid in enumerate(self._solids):
                self._single[body].add_object(body, solid)
        for body, pose in enumerate(self._poses(positions, quaternions)):
            self._single[body].set_transform(body, pose)
        pairs = close_pairs(positions, near_radii(self._radii, within))
        gaps, points = np.empty(len(pairs)), np.empty((len(pairs), 2, 3))
        for k, (i, j) in enumerate(pairs.tolist()):
            gaps[k], found = self._single[i].min_distance_other(self._single[j], return_data=True)
            points[k] = found.point(i), found.point(j)
        return near_pairs(pairs, gaps * self._unit, points * self._unit, within)

    def _poses(self, positions: Floats, quaternions: Floats) -> Floats:
        """(n, 4, 4)."""
        require_finite(positions, quaternions)
        poses = np.tile(np.eye(4), (len(positions), 1, 1))
        poses[:, :3, :3] = rotations(quaternions).as_matrix()
        poses[:, :3, 3] = positions / self._unit
        return poses


BACKEND = Trimesh
