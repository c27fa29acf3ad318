"""What the bodies of a set of cases are made of: the surfaces of its meshes, their hulls, and the sphere."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from harness.arrays import Floats
from harness.scene.hull import convex_hull
from harness.scene.mesh import Surface
from harness.truth.parts import Parts, sphere_parts, surface_parts, together
from harness.vocabulary import Shape

# Around each face of a hull, of the unit of its mesh, in proofs that hulls are apart: more than the faces, which are
# found in floats, can be inside of the true hull.
HULL_SURPLUS = 1e-13


@dataclass(frozen=True)
class Solid:
    """A mesh in one of its shapes.

    Parameters
    ----------
    mesh : its name; empty for the sphere
    shape : what of it a body is
    surface : whose triangles are looked at; a single point for the sphere
    """

    mesh: str
    shape: Shape
    surface: Surface


class Solids:
    """All that bodies are made of, numbered.

    Parameters
    ----------
    surfaces : by the name of the mesh; (v, 3) vertices in units of which a body's size is the number
    used : (mesh, shape), those that occur; the mesh of a sphere is empty
    """

    def __init__(self, surfaces: Mapping[str, Surface], used: Iterable[tuple[str, Shape]]) -> None:
        self.known = {key: place for place, key in enumerate(dict.fromkeys(used))}
        self.all = [_solid(mesh, shape, surfaces) for mesh, shape in self.known]
        trees = {key: _parts(solid) for key, solid in zip(self.known, self.all, strict=True)}
        self.parts: Parts = together([trees[key] for key in self.known])

    def number(self, mesh: str, shape: Shape) -> int:
        """Of a solid."""
        return self.known["" if shape == "sphere" else mesh, shape]


def _solid(mesh: str, shape: Shape, surfaces: Mapping[str, Surface]) -> Solid:
    if shape == "sphere":
        return Solid("", shape, Surface(np.zeros((1, 3)), np.zeros((1, 3), np.int32)))
    surface = surfaces[mesh]
    if shape == "mesh":
        return Solid(mesh, shape, surface)
    hull = convex_hull(surface.vertices)
    _require_all_inside(mesh, surface.vertices, Surface(hull.vertices, hull.faces))
    return Solid(mesh, shape, Surface(hull.vertices, hull.faces))


def _parts(solid: Solid) -> Parts:
    if solid.shape == "sphere":
        return sphere_parts()
    parts = surface_parts(solid.surface.vertices, solid.surface.faces)
    if solid.shape == "mesh":
        return parts
    return parts._replace(
        radii=parts.radii + HULL_SURPLUS, halves=parts.halves + HULL_SURPLUS, around=parts.around + HULL_SURPLUS
    )


def _require_all_inside(name: str, vertices: Floats, hull: Surface) -> None:
    """That no vertex is farther outside of a face than rounding, a hundredth of what is allowed for."""
    a, b, c = (hull.vertices[hull.faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    beyond = (normals @ vertices.T - (normals * a).sum(axis=1)[:, None]) / lengths[:, None]
    if beyond.max() > HULL_SURPLUS / 100 * max(1.0, float(np.abs(vertices).max())):
        raise ArithmeticError(f"{name}: the hull that was found leaves out a vertex by {beyond.max():.2g}")
