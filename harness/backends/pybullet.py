"""pybullet in DIRECT mode: its own broad and narrow phase, without its dynamics. Spheres and convex hulls.

A mesh is replaced by its hull: Bullet never tests two concave meshes against each other, and says nothing about it.
"""

from __future__ import annotations

import weakref

import numpy as np
import pybullet

from harness.arrays import Floats, Pairs
from harness.backends.poses import near_pairs, require_finite
from harness.backends.protocol import NearPairs
from harness.errors import InputError
from harness.narrowphase.units import SMALLEST_UNITS, unit_of_smallest
from harness.scene.hull import Hull, convex_hull
from harness.scene.scene import Scene, Solid
from harness.vocabulary import Query, Shape

# Bullet inflates every hull by this (in its own units) and offers contact points up to 0.02 apart; a margin of zero is
# worse, since real hits are missed. The gap between two hulls is contactDistance + 2 margins.
MARGIN = 0.001
# Of the filter that every moving body has from the start.
_GROUP, _MASK = 1, -1
# Places in a contact point as Bullet returns it; the normal points to the first body.
_BODY_A, _BODY_B, _POINT_A, _POINT_B, _NORMAL, _DISTANCE = 1, 2, 5, 6, 7, 8


class PyBullet:
    """Bullet's collision pipeline, poses set and contacts read once a call.

    Gaps are those of `getClosestPoints`, pair by pair, since no call answers for all. Bullet's broad phase says which
    pairs are asked about, by a box around each body, grown by what is asked for. Less the inflation its gaps of hulls
    are 1e-5 to 2.3e-4 of a size too large, measured on 2900 pairs of its own hulls.
    """

    name = "pybullet"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    queries: tuple[Query, ...] = ("collision", "tolerance", "distance")
    approximations = {"mesh": "pybullet replaces each mesh by its convex hull: it never tests two concave meshes"}  # noqa: RUF012
    units = SMALLEST_UNITS
    precision = "double; hull vertices rounded to 1e-4 of the extent"

    # Against its own hulls, read back: 1e-15 for bodies as they fly, but two vertices that overlap point to point are
    # missed, of pumpkins down to 1e-7 deep, of cubes to 3e-6.
    own_hulls_tolerance = 1e-5

    def tolerance(self, shape: Shape) -> float:
        """Spheres to rounding; coordinates of hulls are quantised to 1e-4 of the extent, and gaps err by twice that."""
        return 1e-15 if shape == "sphere" else 5e-4

    @property
    def own_hulls(self) -> dict[Solid, Hull]:
        """The hulls after their quantisation, by the mesh and the size of a body."""
        return {solid: self._read_back(body) for solid, body in self._first.items()}

    def load(self, scene: Scene) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        # a process has more than one world in its time, of which only the last should count in its memory
        weakref.finalize(self, pybullet.disconnect, self._client)
        self._unit = unit_of_smallest(scene.bodies.sizes)
        self._latest: tuple[tuple[int, ...], ...] = ()
        self._keeps_contacts = scene.shape != "sphere"
        self._inflation = 0.0 if scene.shape == "sphere" else 2 * MARGIN
        shapes: dict[Solid, int] = {}
        self._numbers = {}
        self._first: dict[Solid, int] = {}
        places = (scene.bodies.positions / self._unit).tolist()
        for i, (solid, place) in enumerate(zip(scene.solids, places, strict=True)):
            if solid not in shapes:
                shapes[solid] = self._shape(scene, solid)
            # a mass, because two bodies without one never show a contact; in its place, because bodies that are all
            # made in one place become pairs of it, and thousands of bodies millions of pairs
            body = pybullet.createMultiBody(
                baseMass=1.0, baseCollisionShapeIndex=shapes[solid], basePosition=place, physicsClientId=self._client
            )
            self._numbers[body] = i
            self._first.setdefault(solid, body)
        self._bodies = list(self._numbers)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        client = self._client
        self._place(positions, quaternions)
        if self._keeps_contacts:
            self._forget_contacts()
        pybullet.performCollisionDetection(physicsClientId=client)
        self._latest = pybullet.getContactPoints(physicsClientId=client)
        numbers, inflation = self._numbers, self._inflation
        touching = {
            (numbers[contact[_BODY_A]], numbers[contact[_BODY_B]])
            for contact in self._latest
            if contact[_DISTANCE] + inflation <= 0.0
        }
        ordered = sorted((i, j) if i < j else (j, i) for i, j in touching)
        return np.array(ordered, np.int64).reshape(-1, 2)

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        self._place(positions, quaternions)
        # what touches as inflated is nearer than that by the inflation
        reach = within / self._unit
        pairs = self._close_pairs(reach)
        gaps, points = np.full(len(pairs), np.inf), np.full((len(pairs), 2, 3), np.nan)
        bodies, inflation = self._bodies, self._inflation
        for k, (i, j) in enumerate(pairs.tolist()):
            found = pybullet.getClosestPoints(bodies[i], bodies[j], reach, physicsClientId=self._client)
            if found:
                nearest = min(found, key=lambda point: point[_DISTANCE])
                gaps[k] = nearest[_DISTANCE] + inflation
                # from the inflated surfaces back to those within, along the normal
                shift = np.multiply(nearest[_NORMAL], 0.5 * inflation)
                points[k] = nearest[_POINT_A] + shift, nearest[_POINT_B] - shift
        return near_pairs(pairs, gaps * self._unit, points * self._unit, within)

    def _place(self, positions: Floats, quaternions: Floats) -> None:
        require_finite(positions, quaternions)
        client, place = self._client, pybullet.resetBasePositionAndOrientation
        scaled = (positions / self._unit).tolist()
        turned = quaternions[:, [1, 2, 3, 0]].tolist()
        for body, position, quaternion in zip(self._bodies, scaled, turned, strict=True):
            place(body, position, quaternion, physicsClientId=client)

    def _close_pairs(self, reach: float) -> Pairs:
        """Pairs of bodies whose boxes are at most so far apart, in units."""
        found: set[tuple[int, int]] = set()
        for i, body in enumerate(self._bodies):
            low, high = pybullet.getAABB(body, physicsClientId=self._client)
            low, high = [x - reach for x in low], [x + reach for x in high]
            overlapping = pybullet.getOverlappingObjects(low, high, physicsClientId=self._client) or ()
            found.update((i, j) for other, _ in overlapping if (j := self._numbers[other]) > i)
        return np.array(sorted(found), np.int64).reshape(-1, 2)

    def _forget_contacts(self) -> None:
        """Make Bullet drop the contact points of the call before, at least one body of each pair that has some.

        Bullet keeps the points of two hulls as long as their boxes overlap and the points seem to: bodies that have
        passed through each other are reported at gaps up to .09 of a size. A verdict may depend on the pose alone. A
        body whose filter is set, be it to what it was, gets a new place in the broad phase, and its pairs begin anew.
        Measured in interleaved calls of 50 to 1000 hulls this costs 1.03 to 1.4 times the time without; for all bodies
        1.1 to 1.6; to ask `getClosestPoints` about each hit 1.1 to 1.8; a new client a pose, hundreds of times. Spheres
        begin anew by themselves.
        """
        renewed: set[int] = set()
        for contact in self._latest:
            body = contact[_BODY_A]
            if body not in renewed and contact[_BODY_B] not in renewed:
                pybullet.setCollisionFilterGroupMask(body, -1, _GROUP, _MASK, physicsClientId=self._client)
                renewed.add(body)

    def _read_back(self, body: int) -> Hull:
        _, vertices = pybullet.getMeshData(body, -1, physicsClientId=self._client)
        return convex_hull(np.array(vertices) * self._unit)

    def _shape(self, scene: Scene, solid: Solid) -> int:
        mesh, size = solid[0], solid[1] / self._unit
        if scene.shape == "sphere":
            return int(
                pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=size / 2, physicsClientId=self._client)
            )
        if scene.meshes[mesh].flat:
            raise InputError("it replaces each mesh by its hull, and a flat mesh has none")
        # vertices without indices make a convex hull; with indices they would make a concave mesh
        vertices = (scene.meshes[mesh].hull.vertices * size).tolist()
        return int(pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=vertices, physicsClientId=self._client))


BACKEND = PyBullet
