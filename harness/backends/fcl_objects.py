"""Bodies as FCL collision objects: spheres, convex hulls or triangle meshes, one geometry for all bodies
of a mesh and a size.

FCL checks little: with an empty mesh, an index out of range or a pose that is not finite it crashes or answers wrongly.
Meshes and hulls are valid here, for the scene has checked them, but for faces without area, which make false hits up to
1e-7 apart and are left out; poses are checked before FCL gets them.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import fcl
import numpy as np

from harness.arrays import Floats, Ints
from harness.narrowphase.units import unit_of_smallest
from harness.scene.mesh import Mesh, Triangles, has_area
from harness.scene.scene import Scene, Solid

UNITS = "the smallest size is about 32, by a power of two"
# FCL's test of hulls errs by absolute lengths near 1e-8. In units of the median size it misjudges hulls 2000 times
# smaller by 1e-2 of their size, and of hulls with tiny edges it misses overlaps of 1e-7; with the smallest body 32
# units across, the error is that of the coordinates, for spheres and triangles as before.
_SMALLEST = 32.0


def fcl_unit(sizes: Floats) -> float:
    """The length that FCL is told of as 1, m, for bodies of these sizes, m."""
    return unit_of_smallest(sizes) / _SMALLEST


class FclObjects:
    """One FCL object a body.

    Parameters
    ----------
    scene : Scene
    shared : whether bodies of the same mesh and size share one geometry

    Attributes
    ----------
    objects : list of n fcl.CollisionObject
    geometries : list of n fcl.CollisionGeometry, theirs
    unit : m; FCL's lengths are multiples of it
    """

    def __init__(self, scene: Scene, *, shared: bool = True) -> None:
        self.unit = fcl_unit(scene.bodies.sizes)
        self._turning = scene.shape != "sphere"
        solids = scene.solids
        if shared:
            geometries = {solid: _geometry(scene, solid, self.unit) for solid in dict.fromkeys(solids)}
            self.geometries = [geometries[solid] for solid in solids]
        else:
            self.geometries = [_geometry(scene, solid, self.unit) for solid in solids]
        self.objects = [fcl.CollisionObject(geometry) for geometry in self.geometries]

    def place(self, positions: Floats, quaternions: Floats, bodies: Ints | None = None) -> None:
        """Move objects.

        Parameters
        ----------
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, unit, w x y z; not looked at for spheres
        bodies : (k,) int array, those to move; all of them without

        Raises
        ------
        ValueError
            For a pose that is not finite, which FCL would answer with a crash or a false hit.
        """
        if not (np.isfinite(positions).all() and np.isfinite(quaternions).all()):
            raise ValueError("a pose is not finite")
        objects = self.objects
        if bodies is not None:
            objects, positions, quaternions = [objects[i] for i in bodies], positions[bodies], quaternions[bodies]
        places = positions / self.unit
        if self._turning:
            for placed, place, quaternion in zip(objects, places, quaternions, strict=True):
                placed.setQuatRotation(quaternion)
                placed.setTranslation(place)
        else:
            for placed, place in zip(objects, places, strict=True):
                placed.setTranslation(place)

    def place_one(self, body: int, position: Floats, quaternion: Floats) -> None:
        """Move one object to a finite pose, as `place` does."""
        self.objects[body].setQuatRotation(quaternion)
        self.objects[body].setTranslation(position / self.unit)


# By mesh, then by shape and size in units. A run loads its scene twice, and a judge many scenes of the same meshes.
_made: WeakKeyDictionary[Mesh, dict[tuple[str, float], fcl.CollisionGeometry]] = WeakKeyDictionary()


def _geometry(scene: Scene, shared: Solid, unit: float) -> fcl.CollisionGeometry:
    """Of bodies that share a mesh and a size, in units; m each."""
    mesh, size = shared
    if scene.shape == "sphere":
        return fcl.Sphere(size / unit / 2)
    if shared in scene.hulls:
        return _new_geometry(scene, shared, unit)
    made, key = _made.setdefault(scene.meshes[mesh], {}), (scene.shape, size / unit)
    if key not in made:
        made[key] = _new_geometry(scene, shared, unit)
    return made[key]


def _new_geometry(scene: Scene, shared: Solid, unit: float) -> fcl.CollisionGeometry:
    mesh, size = shared
    solid = scene.solid_of(size, mesh)
    # the unit is a power of two, so neither product loses a digit
    if scene.shape == "hull":
        return _convex(solid.vertices / unit, solid.faces)
    return _surface(solid.vertices / unit, solid.faces[has_area(solid.vertices, solid.faces)])


def _convex(vertices: Floats, faces: Triangles) -> fcl.Convex:
    # each face is preceded by its number of corners
    counted = np.hstack([np.full((len(faces), 1), 3, np.int64), faces.astype(np.int64)])
    return fcl.Convex(vertices, len(faces), counted.ravel())


def _surface(vertices: Floats, faces: Triangles) -> fcl.BVHModel:
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(faces))
    model.addSubModel(vertices, faces)
    model.endModel()
    return model
