"""When hulls or surfaces on folded paths touch: every contact, searched for within the encounters of their spheres.

Between two folds both bodies fly straight and spin evenly, which is the motion that the narrow phase can follow from
the first contact to the last.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.errors import InputError
from harness.motion.kinematics import turn
from harness.narrowphase.contact_intervals import Contacts as Intervals
from harness.narrowphase.contact_intervals import hull_contacts, mesh_contacts
from harness.narrowphase.free_flight import Motion
from harness.narrowphase.mesh_advancement import mesh_shape
from harness.narrowphase.support import support_map
from harness.reference.contacts import Contacts
from harness.reference.folded_paths import folded_paths, straight_pieces
from harness.reference.sphere_contacts import sphere_contacts
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene

# By how much of their radius spheres are enlarged for encounters: methods whose surfaces touch at a tolerance of up to
# this may report a contact before the bounding spheres touch.
ENLARGED = 0.02
# Where a search is given up, it is done again at ten times the tolerance, up to this, of size.
LARGEST_TOLERANCE = 1e-6

Search = Callable[[int, int, Motion, Motion, float, float], Intervals]


def solid_contacts(scene: Scene, duration: float, tolerance: float) -> Contacts:
    """All contacts of hulls or surfaces.

    Parameters
    ----------
    scene : Scene
        Of shape `hull` or `mesh`.
    duration : float
        s
    tolerance : float
        Of the mean size of a pair: the gap at which bodies count as touching.

    Raises
    ------
    InputError
        If a contact cannot be followed, even at a larger tolerance.
    """
    encounters = sphere_contacts(scene.bodies, scene.box, duration, margin=ENLARGED).encounters_without(scene.ignored)
    search = _Search(scene, tolerance)
    windows = zip(encounters.pairs.tolist(), encounters.begin.tolist(), encounters.end.tolist(), strict=True)
    found = [search.within(i, j, begin, end) for (i, j), begin, end in windows]
    contacts = [contact for of_encounter in found for contact in of_encounter]
    return Contacts(
        duration,
        encounters.pairs,
        encounters.begin,
        encounters.end,
        encounter=np.repeat(np.arange(len(found)), [len(of_encounter) for of_encounter in found]),
        onset=np.array([contact.onset for contact in contacts], np.float64),
        release=np.array([contact.release for contact in contacts], np.float64),
    )


class Contact(NamedTuple):
    """From when until when a pair touches, s."""

    onset: float
    release: float


class _Search:
    """Looks for the contacts of pairs of a scene."""

    def __init__(self, scene: Scene, tolerance: float) -> None:
        self._bodies, self._tolerance = scene.bodies, tolerance
        self._paths = folded_paths(scene.bodies, scene.box)
        self._reaches = [float(np.linalg.norm(mesh.hull.vertices, axis=1).max()) for mesh in scene.meshes]
        self._mesh_of = scene.mesh_of.tolist()
        self._search = _hulls(scene.meshes) if scene.shape == "hull" else _surfaces(scene.meshes)

    def within(self, i: int, j: int, begin: float, end: float) -> list[Contact]:
        """The contacts of a pair in a window (s)."""
        found: list[Contact] = []
        for piece in straight_pieces(self._paths, i, j, begin, end):
            start, stop = piece.begin, piece.end
            quaternions = np.empty((2, 4))
            turn(self._bodies.quaternions[[i, j]], self._bodies.spins[[i, j]], start, quaternions)
            one = self._motion(i, piece.places[0], piece.velocities[0], quaternions[0])
            other = self._motion(j, piece.places[1], piece.velocities[1], quaternions[1])
            for onset, release in self._intervals(self._mesh_of[i], self._mesh_of[j], one, other, stop - start):
                # what lasts to the end of one piece goes on in the next
                goes_on = bool(found) and onset == 0.0 and found[-1].release == start
                first = found.pop().onset if goes_on else start + onset
                found.append(Contact(first, stop if release >= stop - start else start + release))
        return found

    def _motion(self, body: int, place: Floats, velocity: Floats, quaternion: Floats) -> Motion:
        size, reach = float(self._bodies.sizes[body]), self._reaches[self._mesh_of[body]]
        (x, y, z), (u, v, w), spin = place.tolist(), velocity.tolist(), self._bodies.spins[body].tolist()
        q0, q1, q2, q3 = quaternion.tolist()
        return Motion((x, y, z), (u, v, w), (q0, q1, q2, q3), (spin[0], spin[1], spin[2]), size, size * reach)

    def _intervals(self, mesh: int, other_mesh: int, one: Motion, other: Motion, end: float) -> list[list[float]]:
        """The contacts of two motions of bodies of these meshes, from time 0 to an end (s)."""
        tolerance = self._tolerance
        while (
            found := self._search(mesh, other_mesh, one, other, end, tolerance * (one.size + other.size) / 2.0)
        ).stalled:
            tolerance *= 10.0
            if tolerance > LARGEST_TOLERANCE:
                raise InputError("the reference cannot follow a contact of these bodies; measure without a reference")
        times: list[list[float]] = found.intervals.tolist()
        return times


def _hulls(meshes: Sequence[Mesh]) -> Search:
    hulls = [support_map(mesh.hull.vertices) for mesh in meshes]
    return lambda i, j, one, other, end, gap: hull_contacts(hulls[i], hulls[j], one, other, 0.0, end, gap)


def _surfaces(meshes: Sequence[Mesh]) -> Search:
    shapes = [mesh_shape(mesh, followed=True) for mesh in meshes]
    return lambda i, j, one, other, end, gap: mesh_contacts(shapes[i], shapes[j], one, other, 0.0, end, gap)
