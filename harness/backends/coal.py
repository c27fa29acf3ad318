"""coal, the successor of hpp-fcl: spheres, convex hulls and meshes, found through its dynamic tree."""

from __future__ import annotations

import coal
import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.poses import SLACK, near_pairs, require_finite
from harness.backends.protocol import NearPairs
from harness.backends.rotations import rotations
from harness.narrowphase.units import UNITS, unit_of
from harness.scene.mesh import Surface
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Query, Shape

# with coal's own 1e-6 more verdicts near touching are wrong
_GJK_TOLERANCE = 1e-12
# coal takes spheres up to 1e-12 apart for touching; of hulls a margin changes nothing but the time, by 1.05 to 1.25.
_SPHERES_MARGIN = -1e-12


class Coal:
    """Hulls and spheres go through the tree at once; meshes where the tree sees their bounding spheres touch.

    Whether pairs touch is asked without contacts, which coal works out by default: the same answers in .75 to .97 of
    the time, measured in interleaved calls. Which pairs are near is asked by its security margin, for which the boxes
    in the tree are grown, so that spheres and hulls take one call; their gaps are those of its contacts. Gaps of
    meshes are those of `coal.distance`, pair by pair, at three times the cost of the margin alone.

    Attributes
    ----------
    accuracy : the tolerance of GJK for gaps, of size; coal's own is 1e-6. Gaps of hulls came out up to three times as
        far off (2.6e-3 at 1e-3, 8e-7 at 1e-6, 4e-14 at 1e-9 and less), those of meshes and spheres to rounding always
    """

    name = "coal"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    queries: tuple[Query, ...] = ("collision", "tolerance", "distance")
    units = UNITS
    precision = "double"
    accuracy = _GJK_TOLERANCE

    def tolerance(self, shape: Shape) -> float:
        """Measured against exact rationals: hulls and triangles up to 1e-6 apart are called hits."""
        return {"sphere": 1e-15, "hull": max(1e-5, 4.0 * self.accuracy)}.get(shape, 1e-5)

    def load(self, scene: Scene) -> None:
        self._request = coal.CollisionRequest()
        self._request.gjk_tolerance, self._request.enable_contact = _GJK_TOLERANCE, False
        self._distance = coal.DistanceRequest()
        self._distance.enable_signed_distance = False  # the depth of an overlap is not asked for
        self._distance.gjk_tolerance = max(self.accuracy, _GJK_TOLERANCE)
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
        return self._touching(positions, quaternions, self._margin, _GJK_TOLERANCE)

    def near(self, positions: Floats, quaternions: Floats, within: float) -> Pairs:
        """The pairs whose gap is at most `within`, m, without their gaps; arguments as for `distances`."""
        margin = within / self._unit + self._margin
        return self._touching(positions, quaternions, margin, self._distance.gjk_tolerance)

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        margin = within / self._unit
        self._place(positions, quaternions, margin)
        if not self._meshes:
            found = self._contacts(margin, self._distance.gjk_tolerance, where=True)
            listed = {_bodies(one): (one.penetration_depth, _points(one)) for one in found}
        else:
            listed = {}
            for i, j in sorted({_bodies(one) for one in self._contacts(margin, _GJK_TOLERANCE)}):
                result = coal.DistanceResult()
                gap = coal.distance(self._meshes[i], self._meshes[j], self._distance, result)
                listed[i, j] = gap, np.array([result.getNearestPoint1(), result.getNearestPoint2()])
        pairs = sorted(listed)
        gaps = np.array([listed[pair][0] for pair in pairs], np.float64) * self._unit
        points = np.array([listed[pair][1] for pair in pairs], np.float64).reshape(-1, 2, 3) * self._unit
        return near_pairs(np.array(pairs, np.int64).reshape(-1, 2), gaps, points, within)

    def _touching(self, positions: Floats, quaternions: Floats, margin: float, tolerance: float) -> Pairs:
        """Pairs that touch when grown by a margin, in units; the tree has the bounding spheres of meshes."""
        self._place(positions, quaternions, margin)
        touching = {_bodies(one) for one in self._contacts(margin, tolerance)}
        if self._meshes:
            self._request.security_margin = margin
            touching = {pair for pair in touching if self._meshes_touch(*pair)}
        return np.array(sorted(touching), np.int64).reshape(-1, 2)

    def _place(self, positions: Floats, quaternions: Floats, margin: float) -> None:
        """Move all bodies, and give the tree their boxes, grown for pairs a margin apart, in units."""
        require_finite(positions, quaternions)
        places, turns = positions / self._unit, rotations(quaternions).as_matrix()
        _place(self._objects, places, turns)
        if margin > 0.0:
            grown = np.full(3, 0.5 * margin * (1.0 + SLACK))
            for held in self._objects:
                held.getAABB().expand(grown)
        self._tree.update()
        if self._meshes:
            _place(self._meshes, places, turns)

    def _contacts(self, margin: float, tolerance: float, where: bool = False) -> list[coal.Contact]:
        """One of each pair that touches when grown by a margin, in units."""
        callback = coal.CollisionCallBackDefault()
        request = callback.data.request
        request.num_max_contacts, request.gjk_tolerance = self._every_pair, tolerance
        request.enable_contact, request.security_margin = where, margin
        self._tree.collide(callback)
        return list(callback.data.result.getContacts())

    def _meshes_touch(self, i: int, j: int) -> bool:
        return bool(coal.collide(self._meshes[i], self._meshes[j], self._request, coal.CollisionResult()))


def _bodies(contact: coal.Contact) -> tuple[int, int]:
    first, second = int(contact.o1.cost_density), int(contact.o2.cost_density)
    return (first, second) if first < second else (second, first)


def _points(contact: coal.Contact) -> Floats:
    """(2, 3) in units: the nearest points of the body of the smaller number and of the other."""
    points = np.array([contact.getNearestPoint1(), contact.getNearestPoint2()])
    return points if contact.o1.cost_density < contact.o2.cost_density else points[::-1]


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
