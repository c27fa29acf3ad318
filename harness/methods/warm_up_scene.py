"""The scene that kernels are compiled with before any run: two bodies that spin and are about to meet."""

from __future__ import annotations

from functools import cache

import numpy as np

from harness.arrays import Pairs
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import hull_of
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.vocabulary import Response, Shape

RESPONSES: tuple[Response, ...] = ("reflect", "elastic", "none")

TOUCHING: Pairs = np.array([[0, 1]])
"""The one pair that there is."""


@cache
def tetrahedron() -> Mesh:
    """The smallest mesh there is, in a sphere of diameter 1."""
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(12)
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], np.int32)
    hull = hull_of(corners, faces)
    return Mesh("tetrahedron", hull.vertices, hull.faces, hull, "", watertight=True, convex=True)


def two_bodies(shape: Shape) -> Scene:
    """Two bodies of a shape, of size 1 m, that spin and fly towards each other."""
    bodies = Bodies(
        positions=np.array([[-0.6, 0, 0], [0.6, 0, 0]]),
        velocities=np.array([[1.0, 1, 1], [-1, -1, -1]]),
        quaternions=np.tile([1.0, 0, 0, 0], (2, 1)),
        spins=np.ones((2, 3)),
        sizes=np.ones(2),
        masses=np.ones(2),
    )
    return Scene(shape, tetrahedron(), bodies, Box(np.full(3, 1.2)))
