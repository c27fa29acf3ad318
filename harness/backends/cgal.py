"""CGAL through libigl: whether meshes intersect, in exact arithmetic. The part is under the GPL, so an extra alone."""

from __future__ import annotations

import igl.copyleft.cgal
import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.close_spheres import close_pairs
from harness.backends.poses import near_radii, require_finite
from harness.backends.rotations import rotations
from harness.scene.mesh import has_area
from harness.scene.scene import Scene
from harness.vocabulary import Shape


class Cgal:
    """Pairs of meshes whose bounding spheres touch, one by one, stopped at the first two triangles that meet.

    It is told of vertices in the world, rounded, and what it says of those is exact. So its verdicts are as good as
    that rounding, and a second opinion beside the judge's, which is told of poses.
    """

    name = "cgal"
    shapes: tuple[Shape, ...] = ("mesh",)
    units = "m, as they are"
    precision = "exact; vertices in the world rounded to double"

    def tolerance(self, shape: Shape) -> float:
        """What rounding the vertices may move them by, a few sizes from the origin."""
        return 1e-14

    def load(self, scene: Scene) -> None:
        self._radii, self._shared = scene.enclosing_radii, scene.solids
        self._solids = {}
        for mesh, size in dict.fromkeys(self._shared):
            solid = scene.solid_of(size, mesh)
            self._solids[mesh, size] = solid.vertices, solid.faces[has_area(*solid)].astype(np.int64)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        require_finite(positions, quaternions)
        turns = rotations(quaternions).as_matrix()
        close = close_pairs(positions, near_radii(self._radii, 0.0))
        placed = {}
        for body in np.unique(close).tolist():
            vertices, faces = self._solids[self._shared[body]]
            placed[body] = vertices @ turns[body].T + positions[body], faces
        touching = [
            pair
            for pair in close.tolist()
            if len(igl.copyleft.cgal.intersect_other(*placed[pair[0]], *placed[pair[1]], True, True)[0])
        ]
        return np.array(touching, np.int64).reshape(-1, 2)


BACKEND = Cgal
