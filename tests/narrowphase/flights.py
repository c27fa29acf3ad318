"""Bodies in free flight that narrow-phase searches are tested with, and FCL as the judge of where they are."""

from functools import cache

import fcl
import numpy as np

from harness.narrowphase.free_flight import Motion, orientation, place
from harness.narrowphase.mesh_advancement import mesh_shape
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import mesh_named, turns

STRAIGHT = (1.0, 0.0, 0.0, 0.0)


@cache
def shape_named(name):
    return mesh_shape(cube_mesh() if name == "cube" else mesh_named(name), followed=True)


def body(position=(0, 0, 0), velocity=(0, 0, 0), quaternion=STRAIGHT, spin=(0, 0, 0), size=1.0):
    vectors = [tuple(map(float, v)) for v in (position, velocity, quaternion, spin)]
    return Motion(*vectors, float(size), size / 2)


class Truth:
    """FCL on the surfaces, wherever the bodies are at a time."""

    def __init__(self, mesh, a, b):
        self._bodies = []
        for motion in (a, b):
            surface = fcl.BVHModel()
            surface.beginModel(len(mesh.vertices), len(mesh.faces))
            surface.addSubModel(mesh.vertices * motion.size, mesh.faces)
            surface.endModel()
            self._bodies.append((motion, fcl.CollisionObject(surface)))

    def _placed(self, time):
        for motion, placed in self._bodies:
            placed.setTransform(fcl.Transform(np.array(orientation(motion, time)), np.array(place(motion, time))))
        return self._bodies[0][1], self._bodies[1][1]

    def touch(self, time):
        return fcl.collide(*self._placed(time), fcl.CollisionRequest(), fcl.CollisionResult()) > 0

    def distance(self, time):
        return fcl.distance(*self._placed(time), fcl.DistanceRequest(), fcl.DistanceResult())


def encounter(seed, spin, apart=(0.7, 1.4)):
    rng = np.random.default_rng(seed)
    sizes = rng.uniform(0.5, 1.5, 2).round(1)
    offset = rng.normal(size=3)
    offset *= sizes.sum() / 2 * rng.uniform(*apart) / np.linalg.norm(offset)
    drift = rng.normal(size=3)
    aim = drift - offset * rng.uniform(0.5, 2) + rng.normal(size=3) * 0.3
    q = turns(rng, 2)
    a = body((3, -2, 1), drift, q[0], rng.normal(size=3) * spin, sizes[0])
    return a, body(offset + np.array((3, -2, 1)), aim, q[1], rng.normal(size=3) * spin, sizes[1])
