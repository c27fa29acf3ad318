"""A defect is shown with no more bodies than it needs, or not at all where one query does not show it."""

import json

import numpy as np
import pytest

from harness.cli.main import main
from harness.compare.comparison import disagreements
from harness.compare.minimise import minimise
from harness.compare.poses import Pose
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.compare.conftest import two_spheres
from tests.conftest import cube_mesh, make_bodies


@pytest.mark.slow
def test_a_defect_that_needs_many_bodies_is_reduced_to_those_it_needs(defective):
    name = defective("swaps")
    positions = [[0, 0, 0], [2, 0, 0], *([k, 3.0, 0] for k in range(4)), [0.4, 0.2, 0.1]]
    scene = Scene("hull", (cube_mesh(),), make_bodies(positions), Box(np.full(3, 20.0)))
    (case, *_) = disagreements(scene, Pose("here", scene.bodies.positions, scene.bodies.quaternions), ("fcl", name))
    small = minimise(case)
    assert len(small.scene.bodies) == 3
    assert (small.scene.bodies.positions == small.scene.bodies.positions.round(1)).all()


@pytest.mark.slow
def test_a_defect_that_depends_on_order_is_reported_with_frame_and_question(defective, tmp_path, capsys):
    path = two_spheres(tmp_path / "rare.yaml", 40)
    names = f"fcl,{defective('drops')}"
    assert main(["compare", path, "--backends", names, "--save", str(tmp_path), "--json"]) == 1
    said = capsys.readouterr()
    (case,) = json.loads(said.out)["cases"]
    assert (case["wrong"], case["file"], case["depends_on_order"]) == ("drops", None, True)
    assert (case["certificate"]["pose"], case["certificate"]["call"]) == ("frame 999", 1000)
    assert "frame 999, call 1000: asked afresh, it was not found again" in said.err
