"""The picture of a case."""

import numpy as np
import pytest

from harness.compare.cross_section import cross_section
from harness.compare.judge import judge
from harness.compare.outcome import Case
from harness.compare.poses import Pose
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies


def test_a_section_cuts_both_bodies_where_they_meet():
    scene = Scene("hull", (cube_mesh(),), make_bodies([[0, 0, 0], [0.7, 0, 0]]), Box(np.full(3, 2.0)))
    pose = Pose("here", scene.bodies.positions, scene.bodies.quaternions)
    case = Case(("a", "b"), "b", (0, 1), judge(scene, 0, 1, pose.positions, pose.quaternions), scene, pose, 1)
    first, second = (np.array(cut) for cut in cross_section(case))
    half = 1 / np.sqrt(12)
    assert np.abs(first[:, [0, 2]] + 0.35).max() == pytest.approx(half, abs=1e-4)
    assert np.abs(second[:, [0, 2]] - 0.35).max() == pytest.approx(half, abs=1e-4)
