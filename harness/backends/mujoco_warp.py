"""MuJoCo's collision pipeline in Warp, mujoco-warp, on the processor: the same spheres and convex hulls, in single
precision.

It is made for graphics cards and many worlds at a time; here it is asked about one, as every other library is.
"""

from __future__ import annotations

import logging

import mujoco
import mujoco_warp
import numpy as np
import warp

from harness.arrays import Floats, Pairs
from harness.backends.mujoco import MuJoCo
from harness.backends.poses import require_finite
from harness.scene.scene import Scene
from harness.vocabulary import Query, Shape

_DEVICE = "cpu"
# Room for contacts and close pairs to begin with, of each body and in all; it grows where there are more.
_CONTACTS_A_BODY, _CONTACTS = 16, 64
_ITERATIONS = 200


class MuJoCoWarp(MuJoCo):
    """`kinematics` and `collision` once a call, of the model that MuJoCo compiles, margin 0: a contact is an overlap.

    It misses hulls whose centres lie apart along a direction of vertices, edges or faces of theirs, to nearly a size
    deep: 154 of 400 cubes so placed. Of the 64 among them that were turned off that direction by 1e-4 rad or more it
    missed none. That is no band, but a defect.

    Its kernels are compiled in a minute when a scene is loaded for the first time on a machine, and kept by Warp.
    """

    name = "mujoco_warp"
    queries: tuple[Query, ...] = ("collision",)
    approximations = {"mesh": "mujoco-warp replaces each mesh by its convex hull: it knows no concave meshes"}  # noqa: RUF012
    precision = "single"
    own_hulls_tolerance = 1e-6

    def tolerance(self, shape: Shape) -> float:
        """Poses and vertices have 24 bits."""
        return 1e-6

    def load(self, scene: Scene) -> None:
        super().load(scene)
        warp.config.log_level = logging.WARNING  # or it tells of every module that it loads
        self._model.opt.ccd_iterations = _ITERATIONS
        with warp.ScopedDevice(_DEVICE):
            self._kernels = mujoco_warp.put_model(self._model)
            self._make_room(_CONTACTS + _CONTACTS_A_BODY * len(scene.bodies))
        self.pairs(scene.bodies.positions, scene.bodies.quaternions)  # compiles the kernels, before any clock

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        require_finite(positions, quaternions)
        poses = np.hstack([positions / self._unit, quaternions]).astype(np.float32).reshape(1, -1)
        with warp.ScopedDevice(_DEVICE):
            while True:
                self._state.qpos.assign(poses)
                mujoco_warp.kinematics(self._kernels, self._state)
                mujoco_warp.collision(self._kernels, self._state)
                count = int(self._state.nacon.numpy()[0])
                # of close pairs that there is no room for, no contact is looked for
                needed = max(count, int(self._state.ncollision.numpy()[0]))
                if needed <= self._room:
                    break
                self._make_room(2 * needed)
        touching = np.sort(self._state.contact.geom.numpy()[:count], axis=1)  # a geom a body, in order
        return np.unique(touching, axis=0).astype(np.int64).reshape(-1, 2)

    def _make_room(self, contacts: int) -> None:
        self._room = contacts
        self._state = mujoco_warp.put_data(self._model, mujoco.MjData(self._model), nconmax=contacts, njmax=1)


BACKEND = MuJoCoWarp
