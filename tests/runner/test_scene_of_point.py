"""The scene that a point declares."""

import numpy as np
import pytest

from harness.experiment.load import load_text
from harness.runner.point import law_of, method_of_point
from harness.runner.scene_of_point import box_of, build_scene, derived_parameters, mesh_count
from harness.scene.scene_files import SceneFiles
from tests.narrowphase.meshes import mesh_named


def scene_of(experiment):
    return build_scene(experiment.points[0], SceneFiles())


def test_the_same_seed_makes_the_same_scene_and_another_does_not(spheres):
    first, again, other = (scene_of(spheres(seed=seed)).bodies for seed in (1, 1, 2))
    assert first.positions.tolist() == again.positions.tolist()
    assert first.velocities.tolist() == again.velocities.tolist()
    assert first.positions.tolist() != other.positions.tolist()


def test_another_speed_leaves_places_directions_and_spins_alone(spheres):
    slow, fast = (scene_of(spheres(speed=speed)).bodies for speed in (1.0, 2.0))
    assert slow.positions.tolist() == fast.positions.tolist()
    assert slow.spins.tolist() == fast.spins.tolist()
    assert np.allclose(2.0 * slow.velocities, fast.velocities)


def test_drawn_values_lie_in_their_ranges(spheres):
    bodies = scene_of(
        spheres(count=200, box=[30, 30, 30], size={"uniform": [0.5, 1.5]}, spin={"choice": [0, 2]})
    ).bodies
    speeds, spins = np.linalg.norm(bodies.velocities, axis=1), np.linalg.norm(bodies.spins, axis=1)
    assert 0.5 <= bodies.sizes.min() < 0.6
    assert 1.4 < bodies.sizes.max() <= 1.5
    assert 0.5 <= speeds.min() <= speeds.max() <= 1.5
    assert set(spins.round(9)) == {0.0, 2.0}
    assert np.allclose(bodies.masses, bodies.sizes**3)
    assert np.allclose(np.linalg.norm(bodies.quaternions, axis=1), 1.0)


@pytest.mark.parametrize(("ratio", "side"), [("1/100", 10), ("1/25", 5), ("1/4", 2)])
def test_the_box_ratio_is_the_square_of_size_over_side(spheres, ratio, side):
    experiment = spheres(box_ratio=ratio, overlap="allow")
    assert box_of(experiment.points[0], SceneFiles()).sides == pytest.approx([side] * 3)


def test_derived_parameters_are_those_of_the_scene(spheres):
    for size in (1.0, {"uniform": [0.5, 1.5]}):
        experiment = spheres(count=20, box=[10, 10, 20], size=size)
        derived, scene = derived_parameters(experiment.points[0], SceneFiles()), scene_of(experiment)
        assert derived["packing"] == pytest.approx(scene.packing)
        assert derived["box_side"] == pytest.approx(2000 ** (1 / 3))


def test_given_bodies_are_taken_as_they_are(spheres):
    text = """
title: Two
scene:
  shape: sphere
  box: [8, 6, 4]
  bodies:
    - {position: [1, 0, 0], velocity: [1, 2, 3], spin: [0, 0, 1], size: 2, orientation: [2, 0, 0, 0]}
    - {position: [1, 0, 0], mass: 5}
"""
    bodies = scene_of(spheres(text)).bodies
    assert bodies.positions.tolist() == [[1, 0, 0], [1, 0, 0]]
    assert bodies.velocities.tolist() == [[1, 2, 3], [0, 0, 0]]
    assert bodies.sizes.tolist() == [2, 1]
    assert bodies.masses.tolist() == [8, 5]
    assert bodies.quaternions.tolist() == [[1, 0, 0, 0], [1, 0, 0, 0]]


OWN_MESHES = """
title: Own meshes
scene:
  mesh: pumpkin-1753.ply
  shape: mesh
  box: [9, 9, 9]
  bodies:
    - {mesh: icosphere-1280.ply, position: [-1, 0, 0], velocity: [1, 0, 0]}
    - {mesh: LAST, position: [1, 0, 0], velocity: [-1, 0, 0]}
engine: {algorithm: grid}
"""


def test_a_mesh_that_no_body_has_is_none_of_the_scene_and_needs_no_stage():
    pumpkin, ball = mesh_named("pumpkin-1753.ply"), mesh_named("icosphere-1280.ply")
    kept = {}
    for last in (pumpkin, ball):
        point = load_text(OWN_MESHES.replace("LAST", last.name), "own.yaml").points[0]
        scene = build_scene(point, SceneFiles((pumpkin, ball)))
        assert [scene.meshes[number] for number in scene.mesh_of] == [ball, last]
        assert len(scene.meshes) == mesh_count(point)
        stages = method_of_point(point).plan(scene, law_of(point, scene)).stages
        kept[last.name] = {stage.name: stage for stage in stages}
    assert "1 of 2 meshes is not convex" in kept[pumpkin.name]["crossing"].why
    assert "the mesh is convex" in kept[ball.name]["crossing"].why
    assert not kept[ball.name]["crossing"].kept
