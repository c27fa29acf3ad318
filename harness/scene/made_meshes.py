"""The meshes that can be made: the pumpkin, and two convex solids whose collisions are known or tend to known ones."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.pumpkin import pumpkin
from harness.scene.simplify import normalised

CUBE_FACES = 12


def make(name: str, faces: int | None) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Vertices and faces of a mesh, its minimal bounding sphere of diameter 1 about the origin.

    Parameters
    ----------
    name : one of `MAKERS`
    faces : how many; None is possible for the cube, which has 12

    Raises
    ------
    InputError
        If the mesh cannot have so many faces.
    """
    return MAKERS[name](faces)


def _pumpkin(faces: int | None) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    if faces is None:
        raise InputError("how many faces the pumpkin is to have must be said: --faces N")
    return pumpkin(faces)


def _icosphere(faces: int | None) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Triangles of an icosahedron divided in four again and again, all vertices on the sphere."""
    possible = [20 * 4**level for level in range(9)]
    if faces not in possible:
        raise InputError(f"an icosphere has {', '.join(map(str, possible[:-1]))} or {possible[-1]} faces, not {faces}")
    solid = trimesh.creation.icosphere(subdivisions=possible.index(faces), radius=0.5)
    return np.asarray(solid.vertices, np.float64), np.asarray(solid.faces, np.int32)


def _cube(faces: int | None) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    if faces not in (None, CUBE_FACES):
        raise InputError(f"a cube has {CUBE_FACES} faces, not {faces}")
    solid = trimesh.creation.box()
    return normalised(np.asarray(solid.vertices, np.float64)), np.asarray(solid.faces, np.int32)


MAKERS = {"pumpkin": _pumpkin, "icosphere": _icosphere, "cube": _cube}
