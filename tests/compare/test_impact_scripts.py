"""Files that ask a library alone when two moving bodies meet, and check with fractions where they are at a moment."""

import re
import subprocess
import sys
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from harness.compare.impact_calls import IMPACT_CALLS
from harness.compare.judge import judge
from harness.compare.outcome import Case
from harness.compare.placing import two_bodies
from harness.compare.poses import Frame
from harness.compare.question import Question
from harness.compare.script import LONGEST_OF_MOTION, _written_of_impact, reproduces, script_of
from tests.conftest import cube_mesh

FIRST_TOUCH = 1.35979  # s, between two moments that the judge has looked at


def case_about(name, shape, *, late, wall=False):
    """Two turning cubes, of which a library is said to miss that they meet, or to tell a time before."""
    positions = np.array([[2.0, 0.3, -0.2], [0.0, 0.0, 0.0]])  # the first spins faster than the second
    quaternions = np.array([[0.6, 0.0, 0.0, 0.8], [0.8, 0.6, 0.0, 0.0]])
    velocities = np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]])
    spins = np.array([[0.0, 0.0, 1.0], [0.0, 0.3, 0.0]])
    scene = two_bodies(shape, (cube_mesh(),), (1.0, 1.0), 0.0)
    moving = {"positions": positions, "quaternions": quaternions, "velocities": velocities, "spins": spins}
    scene = replace(scene, bodies=replace(scene.bodies, **moving))
    if wall:
        velocities = np.array([[0.0, 900.0, 0.0], [0.0, 900.0, 0.0]])
    frame = Frame("frame 1", positions, quaternions, velocities, spins, 2.0, 1)
    moment = FIRST_TOUCH + (0.05 if late else -0.05)
    there = frame.at(scene, moment)
    truth = judge(scene, 0, 1, there.positions, there.quaternions)
    told = inf if late else moment
    return Case((name, "x"), name, (0, 1), truth, scene, frame, 1, Question("impact"), told, moment)


@pytest.mark.slow
@pytest.mark.parametrize("late", [True, False])
@pytest.mark.parametrize(("name", "shape"), sorted(IMPACT_CALLS))
def test_a_file_asks_when_bodies_meet_and_checks_its_proof(name, shape, late, tmp_path):
    pytest.importorskip(name)
    case = case_about(name, shape, late=late)
    assert case.judgement.touching == late
    text = _written_of_impact(case, IMPACT_CALLS[name, shape])
    assert text.count("\n") <= LONGEST_OF_MOTION
    assert "harness" not in text
    path = tmp_path / "reproduction.py"
    path.write_text(text)
    ended = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    if name == "rapier3d":  # right about these cubes: it must not be said to be wrong
        assert float(re.search(r"says at (\S+) s", ended.stdout)[1]) == pytest.approx(FIRST_TOUCH, abs=1e-3)
        assert script_of(case) is None
        assert reproduces(text.replace("return start + hit[1].time_of_impact", f"return {'None' if late else 'T'}"))
    # the places at the moment are those of the motion, and the proof is of these places
    moved = re.sub(r"DURATION, T = 2.0, \S+", "DURATION, T = 2.0, 1.0", text)
    assert not reproduces(moved.replace("said = first_touch()", f"said = {'None' if late else 'T'}"))


@pytest.mark.slow
def test_a_mesh_that_fcl_sees_late_between_its_samples_has_a_file():
    pytest.importorskip("fcl")
    text = script_of(case_about("fcl", "mesh", late=True))
    assert text is not None
    assert reproduces(text)


def test_what_a_wall_turns_has_no_file():
    assert script_of(case_about("rapier3d", "hull", late=True, wall=True)) is None
