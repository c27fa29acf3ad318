"""coal, the successor of hpp-fcl: spheres, convex hulls and meshes, found through its dynamic tree."""

from __future__ import annotations

import coal
import numpy as np
from scipy.spatial.transform import Rotation

from harness.arrays import Floats, Pairs
from harness.narrowphase.units import UNITS, unit_of
from harness.scene.mesh import Surface
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Shape

# with coal's own 1e-6 more verdicts near touching are wrong
_GJK_TOLERANCE = 1e-12
# coal takes spheres up to 1e-12 apart for touching; of hulls a margin changes nothing but the time, by 1.05 to 1.25.
_SPHERES_MARGIN = -1e-12


class Coal:
    """Hulls and spheres go through the tree at once; meshes where the tree sees their bounding spheres touch.

    It is asked whether, not where: without contacts (which are on unless one says so) it gives the same answers in .75
    to .97 of the time, measured in interleaved calls.
    """

    name = "coal"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    units = UNITS
    precision = "double"

    def tolerance(self, shape: Shape) -> float:
        """Measured against exact rationals: hulls and triangles up to 1e-6 apart are called hits."""
        return 1e-15 if shape == "sphere" else 1e-5

    def load(self, scene: Scene) -> None:
        self._request = coal.CollisionRequest()
        self._request.gjk_tolerance, self._request.enable_contact = _GJK_TOLERANCE, False
        self._margin = _SPHERES_MARGIN if scene.shape == "sphere" else 0.0
        self._unit = unit_of(scene.bodies.sizes)
        count = len(scene.bodies)
        self._meshes: list[coal.CollisionObject] = []
        if scene.shape == "mesh":
            models = {solid: _model(_in_units(scene, solid, self._unit)) for solid in dict.fromkeys(scene.solids)}
            self._meshes = [coal.CollisionObject(models[solid], coal.Transform3s()) for solid in scene.solids]
        convex = _hull if scene.shape == "hull" else _sphere
        self._objects = []
        for body, solid in enumerate(scene.solids):
            geometry = convex(scene, solid, self._unit)
            # a contact holds new objects for its geometries; only this number says which body one belongs to
            geometry.cost_density = float(body)
            self._objects.append(coal.CollisionObject(geometry, coal.Transform3s()))
        self._tree = coal.DynamicAABBTreeCollisionManager()
        for held in self._objects:
            self._tree.registerObject(held)
        self._tree.setup()
        self._every_pair = max(1, count * (count - 1) // 2)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        if not (np.isfinite(positions).all() and np.isfinite(quaternions).all()):
            raise ValueError("a pose is not finite")
        places, turns = positions / self._unit, Rotation.from_quat(quaternions[:, [1, 2, 3, 0]]).as_matrix()
        _place(self._objects, places, turns)
        self._tree.update()
        callback = coal.CollisionCallBackDefault()
        request = callback.data.request
        request.num_max_contacts, request.gjk_tolerance = self._every_pair, _GJK_TOLERANCE
        request.enable_contact, request.security_margin = False, self._margin
        self._tree.collide(callback)
        found = callback.data.result.getContacts()
        touching = {tuple(sorted((int(one.o1.cost_density), int(one.o2.cost_density)))) for one in found}
        if self._meshes:
            _place(self._meshes, places, turns)
            touching = {pair for pair in touching if self._meshes_touch(*pair)}
        return np.array(sorted(touching), np.int64).reshape(-1, 2)

    def _meshes_touch(self, i: int, j: int) -> bool:
        return bool(coal.collide(self._meshes[i], self._meshes[j], self._request, coal.CollisionResult()))


def _place(objects: list[coal.CollisionObject], places: Floats, turns: Floats) -> None:
    for held, place, turn in zip(objects, places, turns, strict=True):
        held.setRotation(turn)
        held.setTranslation(place)
        held.computeAABB()


def _in_units(scene: Scene, solid: Solid, unit: float) -> Surface:
    mesh, size = solid
    surface = scene.solid_of(size, mesh)
    return Surface(surface.vertices / unit, surface.faces)


def _sphere(scene: Scene, solid: Solid, unit: float) -> coal.Sphere:
    return coal.Sphere(solid[1] / unit / 2)


def _hull(scene: Scene, solid: Solid, unit: float) -> coal.Convex:
    vertices, faces = _lists(_in_units(scene, solid, unit))
    return coal.Convex(vertices, faces)


def _model(solid: Surface) -> coal.BVHModelOBBRSS:
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(solid.faces), len(solid.vertices))
    model.addSubModel(*_lists(solid))
    model.endModel()
    return model


def _lists(solid: Surface) -> tuple[coal.StdVec_Vec3s, coal.StdVec_Triangle]:
    vertices, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in solid.vertices:
        vertices.append(vertex)
    for face in solid.faces.tolist():
        faces.append(coal.Triangle(*face))
    return vertices, faces


BACKEND = Coal
