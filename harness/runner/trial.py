"""A scene to try things on before anything counts: whatever compiles itself when first used has then been used."""

from __future__ import annotations

import numpy as np

from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import convex_hull
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene, Shape


def trial_scene(shape: Shape) -> Scene:
    """Two spinning tetrahedra that are about to meet."""
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(12)
    hull = convex_hull(corners)
    mesh = Mesh("tetrahedron", hull.vertices, hull.faces, hull, "", watertight=True, convex=True)
    bodies = Bodies(
        positions=np.array([[-0.6, 0, 0], [0.6, 0, 0]]),
        velocities=np.array([[1.0, 1, 1], [-1, -1, -1]]),
        quaternions=np.tile([1.0, 0, 0, 0], (2, 1)),
        spins=np.ones((2, 3)),
        sizes=np.ones(2),
        masses=np.ones(2),
    )
    return Scene(shape, mesh, bodies, Box(np.full(3, 1.2)))
