"""What an audit counts beside disagreements: errors that both share, and approximations."""

import numpy as np
import pytest

from harness.compare.comparison import compare
from harness.compare.minimise import minimise
from harness.compare.poses import Pose, PoseSet, flown
from harness.compare.tally import Approximation
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, needs_pybullet


def at_rest(scene):
    pose = Pose("here", scene.bodies.positions, scene.bodies.quaternions)
    return PoseSet(scene, lambda held: (pose,), hard=True)


@pytest.mark.slow
def test_two_that_are_wrong_together_are_found_by_the_judge(defective):
    names = (defective("blind"), defective("blind-too"))
    scene = Scene("hull", (cube_mesh(),), make_bodies([[0, 0, 0], [0.3, 0, 0]]), Box(np.full(3, 2.0)))
    found = compare([at_rest(scene)], names)
    assert (found.cases, found.unsupported, found.failures) == ([], [], [])
    (case,) = found.shared
    assert case.wrong == "blind and blind-too"
    assert case.judgement.touching
    assert found.checked[0].contradicted == found.checked[0].verdicts == 1
    assert not found.passed
    small = minimise(case)
    assert small is not None
    assert small.wrong == case.wrong


@needs_pybullet
def test_a_hull_for_a_mesh_is_measured_in_false_hits_and_misses():
    # a small one inside a large one touches its hull, but not its surface
    bodies = make_bodies([[0, 0, 0], [0.02, 0, 0], [2, 0, 0], [2.3, 0, 0]], sizes=[1.0, 0.2, 1.0, 1.0])
    scene = Scene("mesh", (cube_mesh(),), bodies, Box(np.full(3, 4.0)))
    found = compare([flown(scene, 0, 1.0)], ("fcl", "pybullet"))
    (one,) = found.approximations
    assert (one.backend, one.verdicts) == ("pybullet", 6)
    assert (one.reported, one.touching, one.false_hits, one.contained, one.misses) == (2, 1, 1, 1, 0)
    assert one.false_share == 0.5
    assert Approximation(("a", "b"), "mesh", "b").missed_share == 0.0
