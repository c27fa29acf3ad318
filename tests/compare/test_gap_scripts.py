"""Files that ask a library alone for a gap, and check the proof of the exact one with fractions."""

import json
import subprocess
import sys
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

from harness.compare.certificate import Judgement
from harness.compare.exact_gap import ExactGap
from harness.compare.library_calls import GAP_CALLS
from harness.compare.outcome import Case
from harness.compare.placing import two_bodies
from harness.compare.poses import Pose
from harness.compare.question import Question
from harness.compare.script import LONGEST, _written_of_gap, reproduces, script_of
from tests.conftest import cube_mesh

MODULES = {"drake": "pydrake"}
PUBLISHED = Path(__file__).parents[2] / "results/published/atlas/gaps/accusations.json"


def case_about(name, shape, told_over_truth, query="distance"):
    """Two cubes askew and apart, of which a library is said to have told so many times the true gap."""
    positions = np.array([[0.0, 0.0, 0.0], [0.9, 0.4, -0.2]])
    quaternions = np.array([[0.8, 0.6, 0.0, 0.0], [0.6, 0.0, 0.0, 0.8]])
    scene = two_bodies(shape, (cube_mesh(),), (1.0, 1.0), 0.0)
    scene = replace(scene, bodies=replace(scene.bodies, positions=positions, quaternions=quaternions))
    pose = Pose("at rest", positions, quaternions)
    exact = ExactGap(scene, pose)
    within = 2.0 * exact.value if told_over_truth > 1.0 else 0.5 * exact.value
    told = told_over_truth * exact.value
    judgement = Judgement(False, exact.value, exact.certificate)
    return Case((name, "x"), name, (0, 1), judgement, scene, pose, 1, Question(query, within), told)


# Runs files one after another: in a process for each, most of the time goes into importing the library anew.
RUN = """
import runpy, sys
for path in sys.argv[1:]:
    code = 0
    try:
        runpy.run_path(path, run_name="__main__")
    except SystemExit as ending:
        code = ending.code or 0
    except AssertionError:  # the proof does not hold
        code = 1
    print(end=f"\\0{code}\\0")
"""


def ran(texts, folder, code=0):
    """What each of the files prints, run without this program; all of them end with a code."""
    paths = [folder / f"{place}.py" for place in range(len(texts))]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text)
    done = subprocess.run([sys.executable, "-c", RUN, *paths], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    *told, rest = done.stdout.split("\0")
    assert (told[1::2], rest) == ([str(code)] * len(texts), ""), done.stderr
    return told[::2]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "shape"), sorted(GAP_CALLS))
def test_a_file_asks_for_a_gap_and_checks_its_proof_and_one_that_shows_nothing_is_not_written(name, shape, tmp_path):
    pytest.importorskip(MODULES.get(name, name))
    right, spoilt = [], []
    for told_over_truth in (1.1, 0.9, inf):
        case = case_about(name, shape, told_over_truth)
        text = _written_of_gap(case, GAP_CALLS[name, shape])
        assert text.count("\n") <= LONGEST
        assert "harness" not in text
        right.append(text)
        # the proof is of this limit: one on the other side of the gap is refused
        known = text.split("limit = Fraction(")[1].split(")")[0]
        other = repr(float(known) * (0.5 if told_over_truth > 1.0 else 2.0))
        spoilt.append(text.replace(f"limit = Fraction({known})", f"limit = Fraction({other})"))
        assert spoilt[-1] != text
    for said in ran(right, tmp_path):
        assert said.endswith("not reproduced: this version answers otherwise\n")
    assert script_of(case) is None
    ran(spoilt, tmp_path, code=1)


def test_a_pair_that_is_not_near_has_a_file_too(tmp_path):
    pytest.importorskip("fcl")
    case = case_about("fcl", "hull", 0.5, "tolerance")
    text = _written_of_gap(case, GAP_CALLS["fcl", "hull"])
    assert reproduces(text.replace("return max(0.0, fcl", "return 0.0 * max(0.0, fcl"))
    assert not reproduces(text)


def test_the_distance_of_fcl_that_is_farthest_off_is_reproduced_without_this_program():
    pytest.importorskip("fcl")
    row = max(
        (row for row in json.loads(PUBLISHED.read_text()) if (row["engine"], row["shape"]) == ("fcl", "hull")),
        key=lambda row: row["off"],
    )
    positions, quaternions = (np.array([body[part] for body in row["bodies"]]) for part in ("position", "quaternion"))
    scene = two_bodies("hull", (cube_mesh(),), tuple(body["size"] for body in row["bodies"]), 0.0)
    scene = replace(scene, bodies=replace(scene.bodies, positions=positions, quaternions=quaternions))
    pose = Pose("at rest", positions, quaternions)
    exact = ExactGap(scene, pose)
    judgement = Judgement(exact.value == 0.0, exact.value, exact.certificate)
    question = Question(row["query"], row["within"])
    case = Case(("fcl", "x"), "fcl", (0, 1), judgement, scene, pose, 1, question, row["told"])
    text = script_of(case)
    assert text is not None
    assert "harness" not in text
