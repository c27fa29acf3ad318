"""Hard poses are what they say: the judge finds the gap they were made with."""

import numpy as np
import pytest

from harness.compare.hard_poses import hard_poses
from harness.compare.judge import judge
from harness.compare.poses import flown
from tests.conftest import cube_mesh, random_scene


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull"])
def test_first_contacts_are_as_far_apart_as_they_say(shape):
    seen = set()
    for pose_set in hard_poses(shape, (cube_mesh(),)):
        sizes = pose_set.scene.bodies.sizes
        for pose in pose_set.poses(pose_set.scene)[:: 1 if shape == "sphere" else 7]:
            if ", gap " not in pose.name:
                continue
            feature, gap = pose.name.split(", gap ")
            truth = judge(pose_set.scene, 0, 1, pose.positions, pose.quaternions)
            rounding = 4e-16 * (np.abs(pose.positions).max() + sizes.max()) * 4
            made = float(gap) * sizes.min()
            slack = rounding + 1e-9 * abs(made)
            # out of an overlap there may be a shorter way than the one that led into it
            assert made - slack <= truth.gap <= max(made, 0.0) + slack, pose.name
            seen.add(feature)
    assert len(seen) == (1 if shape == "sphere" else 9)


@pytest.mark.slow
def test_the_same_poses_are_made_every_time():
    once, again = (list(hard_poses("hull", (cube_mesh(),))) for _ in range(2))
    for one, other in zip(once, again, strict=True):
        for pose, same in zip(one.poses(one.scene), other.poses(other.scene), strict=True):
            assert pose.name == same.name
            assert np.array_equal(pose.positions, same.positions)
            assert np.array_equal(pose.quaternions, same.quaternions)


@pytest.mark.slow
def test_some_small_bodies_lie_inside_large_ones():
    inside = [
        judge(pose_set.scene, 0, 1, pose.positions, pose.quaternions).contained
        for pose_set in hard_poses("mesh", (cube_mesh(),))
        for pose in pose_set.poses(pose_set.scene)
        if pose.name.startswith("centres")
    ]
    assert sum(inside) >= 3


def test_flown_bodies_pass_through_each_other_inside_the_box():
    scene = random_scene("hull", 5, 3.0)
    poses = flown(scene, 200, 0.1).poses(scene)
    assert len(poses) == 201
    assert np.array_equal(poses[0].positions, scene.bodies.positions)
    places = np.array([pose.positions for pose in poses])
    assert np.abs(places).max() <= 1.0 + 1e-12
