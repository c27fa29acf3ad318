"""Where a replay shows that bodies met, and the lines between near ones, against closed forms."""

from pathlib import Path

import numpy as np
import pytest

from harness.experiment.load import load_text
from harness.runner.execute import execute
from harness.runner.servers import files_of
from harness.scene.mesh_child import open_all

TWO = """
title: Two
scene: {{shape: {shape}, {mesh} box: [9, 9, 9], bodies: [{{position: [0, 0, 0], velocity: {still}}},
  {{position: [2, 0.1, 0], velocity: [-1, 0, 0]}}]}}
motion: {{duration: 2, dt: 1/2, response: none}}
engine: {{algorithm: grid, {engine}}}
"""


def recorded(shape, engine, still="[0, 0, 0]"):
    mesh = "" if shape == "sphere" else "mesh: cube.ply,"
    experiment = load_text(TWO.format(shape=shape, mesh=mesh, engine=engine, still=still), Path("two.yaml"))
    point = experiment.points[0]
    found = execute(point, files_of(experiment, point, open_all(experiment.mesh_paths.values())), recorded=True)
    return found.recording


@pytest.mark.parametrize(("shape", "reach"), [("sphere", 1.0), ("hull", 1 / np.sqrt(3)), ("mesh", 1 / np.sqrt(3))])
def test_a_hit_has_the_point_at_which_the_bodies_meet(shape, reach):
    """Spheres of diameter 1 meet in the middle of their centres; cubes of side 1/sqrt(3) in the plane between."""
    found = recorded(shape, "query: impact")
    (time,), (point,) = found.hit_times, found.hit_points
    apart = np.sqrt(reach**2 - 0.01) if shape == "sphere" else reach
    assert abs(time - (2 - apart)) < 1e-5
    assert abs(point[0] - apart / 2) < 1e-5
    assert found.near is None
    if shape == "sphere":
        assert np.abs(point - [apart / 2, 0.05, 0]).max() < 1e-5


@pytest.mark.parametrize("query", ["distance", "tolerance"])
def test_lines_are_between_the_near_points_of_their_frame(query):
    found = recorded("sphere", f"query: {query}, within: 0.6")
    assert found.hit_points is None
    # centres sqrt((2 - t)^2 + 0.01) apart, at 1/2 s: within 0.6 and apart; from 3/2 s on they overlap
    assert found.near.frames.tolist() == [1, 2]
    lengths = np.linalg.norm(found.near.points[:, 0] - found.near.points[:, 1], axis=1)
    assert np.abs(lengths - (np.sqrt([1.5**2 + 0.01, 1 + 0.01]) - 1)).max() < 1e-12


def test_bodies_at_rest_have_their_line_in_every_frame():
    text = TWO.format(shape="sphere", mesh="", engine="query: distance, within: 2", still="[0, 0, 0]")
    experiment = load_text(text.replace("[-1, 0, 0]", "[0, 0, 0]"), Path("two.yaml"))
    found = execute(experiment.points[0], files_of(experiment, experiment.points[0], {}), recorded=True).recording
    assert found.near.frames.tolist() == [1, 2, 3, 4]
    assert np.unique(found.near.points, axis=0).shape == (1, 2, 3)
