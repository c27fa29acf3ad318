"""MuJoCo's collision pipeline, without its dynamics: spheres and convex hulls.

Bodies float freely, are put at their poses, and only kinematics and collision are worked out. MuJoCo knows no concave
mesh: it builds a mesh's convex hull, of vertices rounded to single precision.
"""

from __future__ import annotations

import mujoco
import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.poses import near_pairs, require_finite
from harness.backends.protocol import NearPairs
from harness.errors import InputError
from harness.narrowphase.units import UNITS, unit_of
from harness.scene.hull import Hull, convex_hull
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Query, Shape

# B for contacts (each takes some 600): of 64 neighbours a body, as only deep overlaps of unlike sizes have; memory that
# is never touched costs nothing.
_ARENA_A_BODY, _ARENA = 2**16, 2**24
# With MuJoCo's own 1e-6 and 35 steps hulls up to 1e-8 apart are called hits.
_CCD_TOLERANCE, _CCD_ITERATIONS = 1e-12, 200
# Of the gap that is asked for, up to which one is measured, so that one of just so much is told from a larger one.
_BEYOND = 1.01


class MuJoCo:
    """`mj_kinematics` and `mj_collision` once a call, margin 0: a contact is an overlap.

    With the margin that is asked for a contact is a near pair: MuJoCo culls by itself. Its gap is that of
    `mj_geomDistance`: against the hulls that MuJoCo holds it is right to 1e-14 of a size, where the distance of the
    contact, with margins of some sizes, is off by up to a tenth of one when bodies graze each other, and by more than
    one where sizes differ a hundred times.

    Lengths are told in units of the median size. No verdict of hulls depends on it: sizes of 1e-4 to 1e6 give the same
    verdicts untold, and gaps as exact. But a mesh of 1e-6 is refused for its small volume.
    """

    name = "mujoco"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    queries: tuple[Query, ...] = ("collision", "tolerance", "distance")
    approximations = {"mesh": "mujoco replaces each mesh by its convex hull: it knows no concave meshes"}  # noqa: RUF012
    units = UNITS
    precision = "poses double; hull vertices single"
    # Against its own hulls, read back. Far from the origin, at coordinates of 1e3 sizes and more, it misses overlaps of
    # an edge and a face down to 1e-2 deep; that is no band, but a defect.
    own_hulls_tolerance = 1e-9

    def tolerance(self, shape: Shape) -> float:
        """Spheres to rounding; hull vertices have 24 bits."""
        return 1e-15 if shape == "sphere" else 1e-7

    @property
    def own_hulls(self) -> dict[Solid, Hull]:
        """The hulls after their rounding, by the mesh and the size of a body."""
        return {solid: self._read_back(body) for solid, body in self._first.items()}

    def load(self, scene: Scene) -> None:
        self._unit, self._scene = unit_of(scene.bodies.sizes), scene
        self._compile(scene, _ARENA + _ARENA_A_BODY * len(scene.bodies))

    def _compile(self, scene: Scene, arena: int) -> None:
        spec = mujoco.MjSpec()
        spec.memory = self._arena = arena
        spec.option.ccd_tolerance = _CCD_TOLERANCE
        spec.option.ccd_iterations = _CCD_ITERATIONS
        # further contacts of a pair that touches already
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_MULTICCD
        self._first: dict[Solid, int] = {}
        for body, solid in enumerate(scene.solids):
            self._add_body(spec, scene, solid)
            self._first.setdefault(solid, body)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        if not self._collide(positions, quaternions, 0.0):
            raise MemoryError("mujoco had no room for all contacts")
        touching = np.sort(self._data.contact.geom, axis=1)  # a geom a body, in order
        return np.unique(touching, axis=0).astype(np.int64).reshape(-1, 2)

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        while not self._collide(positions, quaternions, within):
            self._compile(self._scene, 2 * self._arena)
        pairs = np.unique(np.sort(self._data.contact.geom, axis=1), axis=0).astype(np.int64).reshape(-1, 2)
        gaps, ends = np.empty(len(pairs)), np.empty((len(pairs), 6))
        for k, (i, j) in enumerate(pairs.tolist()):
            gaps[k] = mujoco.mj_geomDistance(self._model, self._data, i, j, _BEYOND * within / self._unit, ends[k])
        return near_pairs(pairs, gaps * self._unit, ends.reshape(-1, 2, 3) * self._unit, within)

    def _collide(self, positions: Floats, quaternions: Floats, margin: float) -> bool:
        """Find the contacts of pairs up to a gap, m; False if there was no room for all."""
        require_finite(positions, quaternions)
        model, data = self._model, self._data
        # The margins of two geoms add up in MuJoCo 4.0, where half would do, in .82 of the time; in older versions the
        # larger one counts, and none may lose a pair.
        model.geom_margin[:] = margin / self._unit
        data.qpos[:] = np.hstack([positions / self._unit, quaternions]).ravel()
        data.warning[mujoco.mjtWarning.mjWARN_CONTACTFULL].number = 0
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        return not data.warning[mujoco.mjtWarning.mjWARN_CONTACTFULL].number

    def _add_body(self, spec: mujoco.MjSpec, scene: Scene, solid: Solid) -> None:
        body = spec.worldbody.add_body()
        body.add_freejoint()
        number, size = solid
        if scene.shape == "sphere":
            radius = size / self._unit / 2
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0], mass=1.0)
            return
        mesh = scene.meshes[number]
        if mesh.flat:
            raise InputError("it replaces each mesh by its hull, and a flat mesh has none")
        if solid not in self._first:
            vertices = mesh.hull.vertices * (size / self._unit)
            spec.add_mesh(
                name=str(solid), uservert=vertices.ravel(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            )
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=str(solid), mass=1.0)

    def _read_back(self, body: int) -> Hull:
        model = self._model
        mesh = model.geom_dataid[body]
        start, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        # in a frame of its own, which the geom is placed in
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, model.geom_quat[body])
        vertices = model.mesh_vert[start : start + count].astype(np.float64) @ turn.reshape(3, 3).T
        return convex_hull((vertices + model.geom_pos[body]) * self._unit)


BACKEND = MuJoCo
