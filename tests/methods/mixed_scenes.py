"""Random scenes of 3 to 8 meshes: grid, sap, tree and brute force find the same pairs, and the exact judge agrees.

    python -m tests.methods.mixed_scenes COUNT

The judge is asked about pairs of small meshes, as exact arithmetic on large surfaces takes minutes.
"""

import sys

import numpy as np

from harness.compare.judge import touches
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.launch import directions, orientations
from harness.scene.scene import Scene
from tests.conftest import cube_mesh
from tests.methods.flights import detector
from tests.narrowphase.meshes import mesh_named

NAMES = (
    "icosphere-1280.ply",
    "pumpkin-1753.ply",
    "package:pybullet_data/duck.obj",
    "package:pybullet_data/teddy2_VHACD_CHs.obj",
    "package:pybullet_data/bunny.obj",
    "package:pybullet_data/stone.obj",
    "package:pybullet_data/sphere_smooth.obj",
)
ALGORITHMS = ("grid", "sap", "tree", "brute-force")
JUDGED = 4  # pairs of a scene, half of which touch
FEW = 4000  # faces of a pair that is judged


def mixed_scene(shape, seed):
    """Bodies of 3 to 8 meshes at random, in one size or in many."""
    rng = np.random.default_rng(seed)
    meshes = (cube_mesh(), *(mesh_named(name) for name in NAMES))
    meshes = tuple(meshes[k] for k in np.sort(rng.permutation(len(meshes))[: rng.integers(3, len(meshes) + 1)]))
    count = 10 * len(meshes)
    sizes = np.ones(count) if seed % 2 else rng.uniform(0.4, 1.5, count)
    half = 0.5 * (count / 0.35 * np.pi / 6) ** (1 / 3)
    positions = rng.uniform(-half, half, (count, 3))
    still = np.zeros((count, 3))
    bodies = Bodies(positions, still, orientations(rng, count), directions(rng, count), sizes, sizes**3)
    return Scene(shape, meshes, bodies, Box(np.full(3, half + 1)), mesh_of=np.arange(count) % len(meshes))


def judged(scene, found):
    """Of small meshes, pairs that touch and pairs that do not whose bounding spheres overlap."""
    faces = np.array([len(mesh.faces) for mesh in scene.meshes])[scene.mesh_of]
    positions, radii = scene.bodies.positions, scene.bodies.radii
    overlap = np.linalg.norm(positions[:, None] - positions, axis=2) < np.add.outer(radii, radii)
    near = [(int(i), int(j)) for i, j in np.argwhere(np.triu(overlap, 1)) if faces[i] + faces[j] < FEW]
    for kind in (True, False):
        yield from [pair for pair in near if (pair in found) == kind][: JUDGED // 2]


def check(shape, seed):
    """(pairs found, pairs judged); raises where two methods differ, or the judge does from them."""
    scene = mixed_scene(shape, seed)
    poses = scene.bodies.positions, scene.bodies.quaternions
    answers = {name: detector(scene, name).pairs(*poses).tolist() for name in ALGORITHMS}
    assert all(answer == answers["grid"] for answer in answers.values()), (shape, seed)
    found = {tuple(pair) for pair in answers["grid"]}
    asked = list(judged(scene, found))
    for i, j in asked:
        assert touches(scene, i, j, *poses) == ((i, j) in found), (shape, seed, i, j)
    return len(found), len(asked)


if __name__ == "__main__":
    for shape in ("hull", "mesh"):
        pairs, asked = np.sum([check(shape, seed) for seed in range(int(sys.argv[1]))], axis=0)
        print(
            f"{sys.argv[1]} scenes of {shape}: {pairs} pairs, the same by {', '.join(ALGORITHMS)}; {asked} judged right"
        )
