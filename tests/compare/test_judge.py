"""The judge on bodies whose answer is known, down to gaps that floats cannot tell from nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.compare.families import family_poses
from harness.compare.hard_poses import hard_poses
from harness.compare.judge import judge, touches
from harness.scene.box import Box
from harness.scene.mesh_file import read_mesh
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, random_scene

WIDTH = float(cube_mesh().vertices[:, 0].max()) * 2


def two(shape, offset, *, sizes=(1.0, 1.0), at=0.0, quaternions=None):
    positions = np.array([[at, 0.0, 0.0], [at, 0.0, 0.0]])
    positions[1] += offset
    bodies = make_bodies(positions, sizes=sizes, quaternions=quaternions)
    return judge(Scene(shape, (cube_mesh(),), bodies, Box(np.full(3, 9.0))), 0, 1, bodies.positions, bodies.quaternions)


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@pytest.mark.parametrize("gap", [1e-15, 1e-9, 1e-2])
def test_gaps_are_seen_and_measured(shape, gap):
    width = 1.0 if shape == "sphere" else WIDTH
    aside = 0.0 if shape == "sphere" else 0.03
    apart, overlapping = two(shape, [width + gap, aside, aside]), two(shape, [width - gap, aside, aside])
    assert not apart.touching
    assert overlapping.touching
    assert apart.gap == pytest.approx(gap, rel=0.25, abs=0)
    assert overlapping.gap == pytest.approx(-gap, rel=0.25, abs=0)


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_exact_contact_touches(shape):
    width = 1.0 if shape == "sphere" else WIDTH
    verdict = two(shape, [width, 0, 0])
    assert verdict.touching
    assert verdict.gap == 0.0


def test_a_surface_inside_another_does_not_touch_it_but_is_said_to_be_inside():
    verdict = two("mesh", [0.01, 0.02, 0.0], sizes=(1.0, 0.2))
    assert not verdict.touching
    assert verdict.contained
    assert two("hull", [0.01, 0.02, 0.0], sizes=(1.0, 0.2)).touching
    assert not two("mesh", [2.0, 0, 0]).contained


def test_the_depth_of_hulls_is_the_shortest_way_out():
    assert two("hull", [0.0, 0.3, 0.1]).gap == pytest.approx(0.3 - WIDTH, rel=1e-9)
    # two edges crossed at right angles: the shortest way out is along neither face
    turned = np.array([[np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)], [np.cos(np.pi / 8), 0, np.sin(np.pi / 8), 0]])
    deep = two("hull", [WIDTH * np.sqrt(2) - 0.01, 0, 0], quaternions=turned)
    assert deep.gap == pytest.approx(-0.01, rel=1e-9)


def test_coordinates_far_from_the_origin_lose_nothing():
    for shape in ("sphere", "hull", "mesh"):
        width = 1.0 if shape == "sphere" else WIDTH
        assert not two(shape, [width + 1e-9, 0, 0], at=1e6).touching
        assert two(shape, [width - 1e-9, 0, 0], at=1e6).touching


@pytest.mark.slow
def test_convex_surfaces_cross_where_their_hulls_touch():
    scene = random_scene("hull", 30, 3.0, seed=4)
    surfaces = replace(scene, shape="mesh")
    poses = scene.bodies.positions, scene.bodies.quaternions
    verdicts = []
    for i in range(10):
        for j in range(i + 1, 10):
            hull, mesh = judge(scene, i, j, *poses), judge(surfaces, i, j, *poses)
            assert hull.touching == mesh.touching
            if not hull.touching:
                assert mesh.gap == pytest.approx(hull.gap, rel=1e-9)
            verdicts.append(hull.touching)
    assert 5 < sum(verdicts) < 40


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_the_short_verdict_is_that_of_the_judge(shape):
    for pose_set in list(hard_poses(shape, (cube_mesh(),), 31))[::3]:
        for pose in pose_set.poses(pose_set.scene):
            truth = judge(pose_set.scene, 0, 1, pose.positions, pose.quaternions)
            assert touches(pose_set.scene, 0, 1, pose.positions, pose.quaternions) == truth.touching


@pytest.mark.parametrize("mesh", ["cube.ply", "needle.off"])
def test_bodies_of_unlike_sizes_are_said_to_be_no_deeper_than_they_were_placed(mesh):
    """Where two edges cross, descent from the normals of faces ends far too deep, and engines were accused for it."""
    folder = Path(__file__).parents[2]
    path = next(path for path in (folder / "meshes" / mesh, folder / "experiments/atlas" / mesh) if path.exists())
    placed = 0
    for pose_set in family_poses("sizes", "hull", (read_mesh(path),), 400):
        for pose in pose_set.poses(pose_set.scene):
            features, _, gap = pose.name.partition(", gap ")
            if features == "edge to edge" and float(gap) <= 0.0:
                placed += 1
                found = judge(pose_set.scene, 0, 1, pose.positions, pose.quaternions)
                # of the depth that is said three tenths are proven
                assert -found.gap <= 3.4 * -float(gap) + 1e-12 * pose_set.scene.bodies.sizes.max()
    assert placed > 20
