"""parry3d, the library under rapier, through py-parry3d: spheres, hulls and meshes in double precision."""

from __future__ import annotations

import numpy as np
import py_parry3d
import trimesh

from harness.arrays import Floats, Pairs
from harness.backends.close_spheres import close_pairs
from harness.backends.poses import near_radii, require_finite
from harness.backends.rotations import rotations
from harness.narrowphase.units import UNITS, unit_of
from harness.scene.mesh import has_area
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Query, Shape


class Parry3d:
    """One call for all pairs whose bounding spheres are near, by scipy's tree, for it has no broad phase of its own.

    It says whether pairs touch, or are nearer than a distance, and no more. The second took a thousand times as long as
    the first on meshes of 1753 faces when all pairs of a scene were asked about, far ones too. One thread is used,
    where it would take all.
    """

    name = "parry3d"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    queries: tuple[Query, ...] = ("collision", "tolerance")
    units = UNITS
    precision = "double"

    def tolerance(self, shape: Shape) -> float:
        """Measured: of meshes 395 of 400 poses at gaps near 1e-10 were judged wrongly, and none near 1e-9."""
        return 1e-15 if shape == "sphere" else 1e-9

    def load(self, scene: Scene) -> None:
        py_parry3d.set_num_threads(1)
        self._unit, self._radii = unit_of(scene.bodies.sizes), scene.enclosing_radii
        solids = scene.solids
        shapes = {solid: _shape(scene, solid, self._unit) for solid in dict.fromkeys(solids)}
        self._names = [str(body) for body in range(len(solids))]
        groups = [
            py_parry3d.CollisionGroup(name, [shapes[solid]]) for name, solid in zip(self._names, solids, strict=True)
        ]
        self._world = py_parry3d.CollisionWorld(groups)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return self.near(positions, quaternions, 0.0)

    def near(self, positions: Floats, quaternions: Floats, within: float) -> Pairs:
        """The pairs whose gap is at most `within`, m."""
        require_finite(positions, quaternions)
        close, names = close_pairs(positions, near_radii(self._radii, within)), self._names
        if len(close) == 0:
            return close
        poses = np.tile(np.eye(4), (len(positions), 1, 1))
        poses[:, :3, :3] = rotations(quaternions).as_matrix()
        poses[:, :3, 3] = positions / self._unit
        asked = [(names[i], names[j], within / self._unit) for i, j in close.tolist()]
        near: Pairs = close[np.asarray(self._world.check(dict(zip(names, poses, strict=True)), asked), np.bool_)]
        return near


def _shape(scene: Scene, shared: Solid, unit: float) -> py_parry3d.Shape:
    mesh, size = shared
    if scene.shape == "sphere":
        return py_parry3d.Sphere(size / unit / 2)
    solid = scene.solid_of(size, mesh)
    vertices = solid.vertices / unit
    if scene.shape == "hull":
        return py_parry3d.ConvexHull_from_trimesh(trimesh.Trimesh(vertices, solid.faces, process=False))
    return py_parry3d.TriMesh(vertices, solid.faces[has_area(*solid)].astype(np.uint32))


BACKEND = Parry3d
