"""Bounds on how far bodies can get."""

import numpy as np
import pytest

from harness.motion import reach
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import make_bodies


@pytest.mark.parametrize("few", [0, reach.FEW])
def test_whether_two_bodies_can_meet_is_the_same_by_every_pair_and_by_a_grid(few, monkeypatch):
    monkeypatch.setattr(reach, "FEW", few)
    for gap, meet in ((1e-6, False), (-1e-6, True)):
        # 1 across each, they fly towards each other at 1 m/s for 2 s
        places = [[-2.5 - gap, 0, 0], [2.5, 0, 0], [0, 30, 0]]
        bodies = make_bodies(places, [[1, 0, 0], [-1, 0, 0], [0, 0, 0]])
        scene = Scene("sphere", (), bodies, Box(np.full(3, 50.0)))
        assert reach.no_pair_can_meet(scene, 2.0) is not meet
        assert not reach.no_pair_can_meet(scene, 2.0, within=1.0)
