"""ipctk, the toolkit of incremental potential contact: meshes, and when they meet, in double precision."""

from __future__ import annotations

from itertools import pairwise

import ipctk
import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.close_spheres import close_pairs
from harness.backends.poses import UniformMotion, impact_times, near_radii, require_finite
from harness.backends.protocol import ImpactTimes
from harness.backends.rotations import rotations
from harness.narrowphase.units import UNITS, unit_of
from harness.scene.mesh import Triangles, has_area
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Query, Shape

# rad that a body turns in a part of a frame: between its ends vertices move straight, inside of their arcs by at most
# an eighth of the square of it, of half a size
_LARGEST_TURN = 0.02
# Of a pair's gap at the start of a part, what it leaves: additive advancement stops short of contact by so much.
_LEFT = 1e-6


class Ipctk:
    """A pair is one mesh of two bodies; the pairs are those whose bounding spheres touch, by scipy's tree.

    A mesh of all bodies would be searched at once, but says only that some intersect. Intersections are of edges with
    faces; continuous collision is additive (the inclusion-based one took up to 1000 times as long), on vertices that
    move straight, so that a frame is cut into parts in which bodies turn by little. The toolkit's own rotating motion
    is for single vertices and faces, at 3 to 305 ms each.
    """

    name = "ipctk"
    shapes: tuple[Shape, ...] = ("mesh",)
    queries: tuple[Query, ...] = ("collision", "impact")
    units = UNITS
    precision = "double"

    def tolerance(self, shape: Shape) -> float:
        """No wrong verdict was found at gaps near 1e-10."""
        return 1e-11

    def load(self, scene: Scene) -> None:
        ipctk.set_num_threads(1)
        self._unit, self._radii = unit_of(scene.bodies.sizes), scene.enclosing_radii
        self._solids = scene.solids
        self._vertices: dict[Solid, Floats] = {}
        self._faces: dict[Solid, Triangles] = {}
        for shared in dict.fromkeys(self._solids):
            mesh, size = shared
            solid = scene.solid_of(size, mesh)
            self._vertices[shared] = solid.vertices / self._unit
            self._faces[shared] = solid.faces[has_area(*solid)]
        self._meshes: dict[tuple[Solid, Solid], ipctk.CollisionMesh] = {}
        self._broad_phase = ipctk.LBVH()
        self._advancement = ipctk.AdditiveCCD(conservative_rescaling=1.0 - _LEFT)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        require_finite(positions, quaternions)
        close = close_pairs(positions, near_radii(self._radii, 0.0))
        placed = self._placed(positions, quaternions, np.unique(close))
        touching = [(i, j) for i, j in close.tolist() if self._intersect(i, j, placed)]
        return np.array(touching, np.int64).reshape(-1, 2)

    def impacts(
        self, positions: Floats, quaternions: Floats, velocities: Floats, spins: Floats, duration: float
    ) -> ImpactTimes:
        """Late by what straight vertices leave of their arcs, at most 2.5e-5 of a size; else early, by 1e-6."""
        require_finite(positions, quaternions, velocities, spins)
        motion = UniformMotion(positions, quaternions, velocities, spins, duration)
        close = close_pairs(motion.middle(), motion.swept_radii(self._radii))
        at_start = self._placed(positions, quaternions, np.unique(close))
        apart = [(i, j) for i, j in close.tolist() if not self._intersect(i, j, at_start)]
        found = []
        for start, end in pairwise(motion.steps(_LARGEST_TURN).tolist()):
            at_end = self._placed(*motion.at(end), np.unique(apart).astype(np.int64))
            steps = [self._free_step(i, j, at_start, at_end) for i, j in apart]
            found += [
                (*pair, start + step * (end - start)) for pair, step in zip(apart, steps, strict=True) if step < 1.0
            ]
            apart = [pair for pair, step in zip(apart, steps, strict=True) if step >= 1.0]
            at_start = at_end
        return impact_times(found, duration)

    def _placed(self, positions: Floats, quaternions: Floats, bodies: Pairs) -> dict[int, Floats]:
        """The vertices of some bodies, in units."""
        turns, places = rotations(quaternions).as_matrix(), positions / self._unit
        return {body: self._vertices[self._solids[body]] @ turns[body].T + places[body] for body in bodies.tolist()}

    def _intersect(self, i: int, j: int, placed: dict[int, Floats]) -> bool:
        vertices = np.asfortranarray(np.concatenate([placed[i], placed[j]]))
        return bool(ipctk.has_intersections(self._mesh(i, j), vertices, self._broad_phase))

    def _free_step(self, i: int, j: int, start: dict[int, Floats], end: dict[int, Floats]) -> float:
        """The part of the way that two bodies can go without touching; 1 for all of it."""
        before, after = (np.asfortranarray(np.concatenate([placed[i], placed[j]])) for placed in (start, end))
        return float(
            ipctk.compute_collision_free_stepsize(
                self._mesh(i, j),
                before,
                after,
                broad_phase=self._broad_phase,
                narrow_phase_ccd=self._advancement,
            )
        )

    def _mesh(self, i: int, j: int) -> ipctk.CollisionMesh:
        """The two bodies as one mesh, which does not collide with itself but for them; one for pairs alike."""
        solids = self._solids[i], self._solids[j]
        if solids not in self._meshes:
            vertices = [self._vertices[solid] for solid in solids]
            faces = np.concatenate([self._faces[solids[0]], self._faces[solids[1]] + len(vertices[0])])
            faces = faces.astype(np.int32)
            faces = np.asfortranarray(faces)
            mesh = ipctk.CollisionMesh(np.asfortranarray(np.concatenate(vertices)), ipctk.edges(faces), faces)
            owners = np.repeat([0, 1], [len(part) for part in vertices]).astype(np.int32)
            mesh.can_collide = ipctk.make_vertex_patches_filter(owners)
            self._meshes[solids] = mesh
        return self._meshes[solids]


BACKEND = Ipctk
