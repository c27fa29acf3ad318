"""rapier3d, the Rust engine and its parry library through Python: spheres, hulls and meshes in single precision."""

from __future__ import annotations

import numpy as np
import rapier3d

from harness.arrays import Floats, Pairs
from harness.backends.poses import UniformMotion, impact_times, near_pairs, require_finite
from harness.backends.protocol import ImpactTimes, NearPairs
from harness.backends.rapier_casts import Casts, ShapeData
from harness.backends.rotations import rotations
from harness.errors import InputError
from harness.narrowphase.units import UNITS, unit_of
from harness.scene.mesh import has_area
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Query, Shape

# Relative: by how much spheres are grown, so that single precision loses no pair.
_SLACK = 1e-5


class Rapier3d:
    """One step of the collision pipeline, without dynamics, answers for all pairs behind a tree of its own.

    Whether pairs touch is asked of sensors, of which the pipeline works out no more than that; it finds the same pairs
    as by contacts. It has no query for distances of shapes, but contacts up to a prediction distance: their gaps are
    off by 1e-7 of a size in the median and by 9e-4 at most, of 85 pairs of hulls of 280 vertices. Of meshes a contact
    has every pair of triangles within the distance, which takes some 20 times as long for cubes as to see whether they
    touch, and more than 90 s for 40 meshes of 1753 faces: no gaps of meshes are asked for.
    `Casts` finds when pairs meet.
    """

    name = "rapier3d"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    gap_shapes: tuple[Shape, ...] = ("sphere", "hull")
    queries: tuple[Query, ...] = ("collision", "tolerance", "distance", "impact")
    units = UNITS
    precision = "single"

    def tolerance(self, shape: Shape) -> float:
        """Of poses and shapes in 24 bits, tens of sizes from the middle of the scene."""
        return 1e-5

    def load(self, scene: Scene) -> None:
        self._scene, self._unit = scene, unit_of(scene.bodies.sizes)
        data = {solid: _shape_data(scene, solid, self._unit) for solid in dict.fromkeys(scene.solids)}
        shapes = {solid: shape.make() for solid, shape in data.items()}
        self._shapes = [shapes[solid] for solid in scene.solids]
        self._sensors = _World(self._shapes, sensor=True)
        self._solids: _World | None = None
        self._spheres, self._radii = self._sensors, np.empty(0)
        self._casts = Casts(data, scene.solids, self._unit)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        require_finite(positions, quaternions)
        return self._sensors.overlapping((positions - _middle(positions)) / self._unit, quaternions)

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        """Raises InputError for meshes."""
        require_finite(positions, quaternions)
        if self._scene.shape == "mesh":
            raise InputError("it has no gaps of meshes")
        if self._solids is None:
            self._solids = _World(self._shapes, sensor=False)
        middle = _middle(positions)
        places = (positions - middle) / self._unit
        pairs, gaps, points = self._solids.contacts(places, quaternions, within / self._unit)
        return near_pairs(pairs, gaps * self._unit, points * self._unit + middle, within)

    def impacts(
        self, positions: Floats, quaternions: Floats, velocities: Floats, spins: Floats, duration: float
    ) -> ImpactTimes:
        """Late or early by what single precision leaves, and now and then by more; see `Casts`."""
        require_finite(positions, quaternions, velocities, spins)
        if self._scene.shape == "sphere":
            spins = np.zeros_like(spins)  # no part in when they meet, and then one cast does
        motion = UniformMotion(positions, quaternions, velocities, spins, duration)
        close = self._close_pairs(motion)
        touching = {tuple(pair) for pair in self.pairs(positions, quaternions).tolist()}
        apart = np.array([pair for pair in close.tolist() if tuple(pair) not in touching], np.int64).reshape(-1, 2)
        return impact_times(self._casts.impacts(apart, motion), duration)

    def _close_pairs(self, motion: UniformMotion) -> Pairs:
        """Pairs whose bounding spheres touch on their way, by the pipeline's tree; made anew when the radii change."""
        radii = motion.swept_radii(self._scene.enclosing_radii) * (1.0 + _SLACK) / self._unit
        if not np.array_equal(radii, self._radii):
            self._radii = radii
            self._spheres = _World([rapier3d.SharedShape.ball(radius) for radius in radii.tolist()], sensor=True)
        centres = motion.middle()
        return self._spheres.overlapping((centres - _middle(centres)) / self._unit, motion.quaternions)


class _World:
    """Colliders without bodies: of sensors it is known whether two overlap, of the others the contacts."""

    def __init__(self, shapes: list[rapier3d.SharedShape], *, sensor: bool) -> None:
        self._bodies, self._colliders = rapier3d.RigidBodySet(), rapier3d.ColliderSet()
        self._islands, self._pipeline = rapier3d.IslandManager(), rapier3d.CollisionPipeline()
        self._broad_phase, self._narrow_phase = rapier3d.BroadPhaseBvh(), rapier3d.NarrowPhase()
        kinds = rapier3d.ActiveCollisionTypes.all()  # without bodies all are fixed, which else are not tested
        self._handles = [
            self._colliders.insert(rapier3d.Collider.new(shape).sensor(sensor).active_collision_types(kinds))
            for shape in shapes
        ]
        self._numbers = {handle: number for number, handle in enumerate(self._handles)}

    def overlapping(self, places: Floats, quaternions: Floats) -> Pairs:
        """Pairs of sensors that touch; places (n, 3) in units."""
        self._step(places, quaternions, 0.0)
        found = self._narrow_phase.intersection_pairs()
        return _sorted([self._pair(first, second) for first, second, touching in found if touching])

    def contacts(self, places: Floats, quaternions: Floats, within: float) -> tuple[Pairs, Floats, Floats]:
        """Pairs (k, 2) with a contact up to a distance, its gaps (k,) and points (k, 2, 3), all in units."""
        # contacts of the call before would be kept where bodies have moved little
        self._narrow_phase.clear()
        self._broad_phase.clear()
        self._step(places, quaternions, within)
        turns, found = rotations(quaternions).as_matrix(), {}
        for pair in self._narrow_phase.contact_pairs():
            deepest = pair.find_deepest_contact()
            if deepest is not None:
                first, second = pair.collider1, pair.collider2
                numbers = self._numbers[first], self._numbers[second]
                local = (deepest.local_p1, deepest.local_p2)
                points = [turns[k] @ (p.x, p.y, p.z) + places[k] for k, p in zip(numbers, local, strict=True)]
                swapped = numbers[0] > numbers[1]
                found[self._pair(first, second)] = deepest.dist, points[::-1] if swapped else points
        pairs = sorted(found)
        gaps = np.array([found[pair][0] for pair in pairs], np.float64)
        return _sorted(pairs), gaps, np.array([found[pair][1] for pair in pairs], np.float64).reshape(-1, 2, 3)

    def _pair(self, first: rapier3d.ColliderHandle, second: rapier3d.ColliderHandle) -> tuple[int, int]:
        i, j = self._numbers[first], self._numbers[second]
        return (i, j) if i < j else (j, i)

    def _step(self, places: Floats, quaternions: Floats, within: float) -> None:
        colliders, vector, turn = self._colliders, rapier3d.Vec3, rapier3d.Rotation3
        for handle, place, quaternion in zip(self._handles, places.tolist(), quaternions.tolist(), strict=True):
            colliders[handle].position = rapier3d.Isometry3(vector(*place), turn(*quaternion))
        self._pipeline.step(within, self._islands, self._broad_phase, self._narrow_phase, self._bodies, self._colliders)


def _middle(places: Floats) -> Floats:
    """(3,) between the outermost of some places, from which they are told: single precision has few digits to lose."""
    if len(places) == 0:
        return np.zeros(3)
    middle: Floats = 0.5 * (places.min(axis=0) + places.max(axis=0))
    return middle


def _sorted(pairs: list[tuple[int, int]]) -> Pairs:
    return np.array(sorted(pairs), np.int64).reshape(-1, 2)


def _shape_data(scene: Scene, solid: Solid, unit: float) -> ShapeData:
    mesh, size = solid
    if scene.shape == "sphere":
        return ShapeData(size / unit / 2, [], [])
    surface = scene.solid_of(size, mesh)
    faces = surface.faces[has_area(*surface)].tolist() if scene.shape == "mesh" else []
    return ShapeData(0.0, (surface.vertices / unit).tolist(), faces)


BACKEND = Rapier3d
