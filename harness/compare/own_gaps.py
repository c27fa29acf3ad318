"""The gap kernels of this program in the form of a backend, so that an atlas asks them as it asks every library."""

from __future__ import annotations

from functools import cache

import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.protocol import NearPairs
from harness.methods.warm_up_scene import two_bodies
from harness.narrowphase.gap import EXACT, MeshGapShape, mesh_gap_shape
from harness.narrowphase.pose_gaps import Gaps, Poses, hull_gaps, mesh_gaps, sphere_gaps
from harness.scene.scene import Scene
from harness.vocabulary import OWN, Query, Shape


class OwnGaps:
    """What `harness.distance` asks, of the two bodies of a scene."""

    name = OWN
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    queries: tuple[Query, ...] = ("tolerance", "distance")

    def tolerance(self, shape: Shape) -> float:
        """The gap is known up to rounding of 1e-15 of the sizes and of the distance, several times over."""
        return 1e-14

    def load(self, scene: Scene) -> None:
        self._scene = scene
        made = [mesh_gap_shape(mesh) for mesh in scene.meshes] if scene.shape != "sphere" else []
        self._shapes: list[MeshGapShape] = [made[number] for number in scene.mesh_of.tolist()] if made else []

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return self.distances(positions, quaternions, 0.0).pairs

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        sizes = self._scene.bodies.sizes.tolist()
        one, other = (Poses(positions[k : k + 1], quaternions[k : k + 1], sizes[k]) for k in (0, 1))
        found = Gaps(np.empty(1), np.empty((1, 2, 3)))
        if not self._shapes:
            sphere_gaps(one, other, EXACT, found)
        elif self._scene.shape == "hull":
            hull_gaps(self._shapes[0].mesh.hull, self._shapes[1].mesh.hull, one, other, EXACT, found)
        else:
            mesh_gaps(self._shapes[0], self._shapes[1], one, other, EXACT, found)
        near = found.gaps <= within
        pairs = np.array([[0, 1]], np.int64)[near]
        return NearPairs(pairs, found.gaps[near], found.points[near])


@cache
def compile_own_gaps(shape: Shape) -> None:
    """Compile what is asked about bodies of a shape."""
    scene = two_bodies(shape)
    own = OwnGaps()
    own.load(scene)
    own.distances(scene.bodies.positions, scene.bodies.quaternions, 0.0)
