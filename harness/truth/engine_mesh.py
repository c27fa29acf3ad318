"""A surface of a set as the engine and the backends take it: its vertices as they stand, not normalised anew."""

from __future__ import annotations

import numpy as np

from harness.scene.hull import convex_hull
from harness.scene.mesh import Mesh, Surface, digest
from harness.scene.topology import is_own_hull, topology


def engine_mesh(name: str, surface: Surface) -> Mesh:
    """The mesh of a surface whose unit is the diameter of a sphere that holds it."""
    vertices, faces = np.array(surface.vertices, np.float64), np.array(surface.faces, np.int32)
    vertices.setflags(write=False)
    faces.setflags(write=False)
    hull = convex_hull(vertices)
    watertight = topology(faces, len(vertices)).watertight
    return Mesh(name, vertices, faces, hull, digest(vertices, faces), watertight, is_own_hull(vertices, faces, hull))
