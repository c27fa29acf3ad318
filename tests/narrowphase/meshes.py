"""Meshes that the narrow phase is tested with: from this project and from pybullet_data."""

from functools import cache
from pathlib import Path

import numpy as np

from harness.experiment.mesh_location import locate_mesh
from harness.scene.box import Box
from harness.scene.mesh_file import read_mesh
from harness.scene.scene import Scene
from tests.conftest import make_bodies

MESHES = [
    "pumpkin-1753.ply",
    "package:pybullet_data/duck.obj",
    "package:pybullet_data/soccerball.obj",
    "package:pybullet_data/teddy2_VHACD_CHs.obj",
]


@cache
def mesh_named(name):
    return read_mesh(locate_mesh(name, Path(__file__).parents[2] / "meshes"))


def turns(rng, count):
    quaternions = rng.normal(size=(count, 4))
    return quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)


def crowd(mesh, shape, count, side, seed, sizes=None):
    """Bodies of any orientation, anywhere in a cube, overlapping as chance has it."""
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-side / 2, side / 2, (count, 3))
    bodies = make_bodies(
        positions,
        rng.normal(size=(count, 3)),
        sizes=sizes,
        quaternions=turns(rng, count),
        spins=rng.normal(size=(count, 3)),
    )
    return Scene(shape, (mesh,), bodies, Box(np.full(3, side)))
