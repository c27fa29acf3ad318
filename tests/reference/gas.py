"""Balls of mixed sizes that pass through each other in a small box."""

import numpy as np

from harness.scene.box import Box
from tests.conftest import make_bodies


def gas(seed, count=12, half=(1.5, 1.8, 2.0)):
    rng = np.random.default_rng(seed)
    sizes = rng.uniform(0.2, 1.0, count)
    box = Box(np.array(half))
    room = box.half - sizes[:, None] / 2
    return make_bodies(rng.uniform(-room, room), rng.normal(size=(count, 3)) * 2, sizes=sizes), box
