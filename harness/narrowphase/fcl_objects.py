"""Bodies as FCL collision objects: spheres, convex hulls or triangle meshes, one geometry for all bodies of a size.

FCL checks little: an empty mesh, an index out of range or a pose that is not finite crashes it or makes it lie. Meshes
and hulls are sound by construction here (the scene has validated them); poses are checked before FCL sees them.
"""

from __future__ import annotations

import fcl
import numpy as np

from harness.arrays import Floats
from harness.narrowphase.units import unit_of
from harness.scene.hull import Hull
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene


class FclObjects:
    """One FCL object a body; bodies of the same size share their geometry.

    Parameters
    ----------
    scene : Scene

    Attributes
    ----------
    objects : list of n fcl.CollisionObject
    unit : m; FCL's lengths are multiples of it
    """

    def __init__(self, scene: Scene) -> None:
        self.unit = unit_of(scene.bodies.sizes)
        self._turning = scene.shape != "sphere"
        geometries: dict[float, fcl.CollisionGeometry] = {}
        self.objects: list[fcl.CollisionObject] = []
        for size in (scene.bodies.sizes / self.unit).tolist():
            if size not in geometries:
                geometries[size] = _geometry(scene, size)
            self.objects.append(fcl.CollisionObject(geometries[size]))

    def place(self, positions: Floats, quaternions: Floats) -> None:
        """Move all objects.

        Parameters
        ----------
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, unit, w x y z; not looked at for spheres

        Raises
        ------
        ValueError
            For a pose that is not finite, which FCL would answer with a crash or a false hit.
        """
        if not (np.isfinite(positions).all() and np.isfinite(quaternions).all()):
            raise ValueError("a pose is not finite")
        places = positions / self.unit
        if self._turning:
            for placed, place, quaternion in zip(self.objects, places, quaternions, strict=True):
                placed.setQuatRotation(quaternion)
                placed.setTranslation(place)
        else:
            for placed, place in zip(self.objects, places, strict=True):
                placed.setTranslation(place)

    def place_one(self, body: int, position: Floats, quaternion: Floats) -> None:
        """Move one object to a finite pose, as `place` does."""
        self.objects[body].setQuatRotation(quaternion)
        self.objects[body].setTranslation(position / self.unit)


def _geometry(scene: Scene, size: float) -> fcl.CollisionGeometry:
    if scene.shape == "sphere" or scene.mesh is None:
        return fcl.Sphere(size / 2)
    return _convex(scene.mesh.hull, size) if scene.shape == "hull" else _surface(scene.mesh, size)


def _convex(hull: Hull, size: float) -> fcl.Convex:
    # each face is preceded by its number of corners
    faces = np.hstack([np.full((len(hull.faces), 1), 3, np.int64), hull.faces.astype(np.int64)])
    return fcl.Convex(hull.vertices * size, len(hull.faces), faces.ravel())


def _surface(mesh: Mesh, size: float) -> fcl.BVHModel:
    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices * size, mesh.faces)
    model.endModel()
    return model
