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


def of_meshes(meshes: int) -> str:
    """What sets the name of a warm-up of a scene of several meshes apart."""
    return " of several meshes" if meshes > 1 else ""


def two_bodies(shape: Shape, meshes: int = 1) -> Scene:
    """Two bodies of a shape, of size 1 m, that spin and fly towards each other; each of a mesh of its own if several.

    Parameters
    ----------
    shape : Shape
    meshes : how many meshes the scene has that is warmed up for, of which only 1 differs from all others
    """
    bodies = Bodies(
        positions=np.array([[-0.6, 0, 0], [0.6, 0, 0]]),
        velocities=np.array([[1.0, 1, 1], [-1, -1, -1]]),
        quaternions=np.tile([1.0, 0, 0, 0], (2, 1)),
        spins=np.ones((2, 3)),
        sizes=np.ones(2),
        masses=np.ones(2),
    )
    several = meshes > 1 and shape != "sphere"
    made, mesh_of = ((tetrahedron(),) * 2, [0, 1]) if several else ((tetrahedron(),), [0, 0])
    return Scene(shape, made, bodies, Box(np.full(3, 1.2)), mesh_of=np.array(mesh_of))
