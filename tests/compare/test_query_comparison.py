"""Methods asked for near pairs, gaps and times of impact: the wrong one is named with a proof, and nobody else."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from harness.cli.main import main
from harness.compare.comparison import compare
from harness.compare.hard_questions import hard_questions
from harness.compare.poses import Frame, PoseSet, flown
from harness.compare.question import Question
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.compare.liars import POINT_LIARS, QUERY_LIARS, install
from tests.conftest import cube_mesh, make_bodies, random_scene, slow_beyond

DISTANCE, NEAR, IMPACT = (Question(query, 0.2) for query in ("distance", "tolerance", "impact"))
HONEST = ("fcl", "fcl/grid")
QUICK = ("gaps-too-wide", "early")  # one a question


@pytest.fixture
def liar(tmp_path, monkeypatch):
    return lambda name: install(name, tmp_path / "plugins", monkeypatch)


def crowd(question, shape="hull"):
    """Frames in which many bodies are near, and some meet."""
    return flown(random_scene(shape, 12, 3.0, seed=4), 8, 1 / 20, question)


def named(found):
    return {case.wrong for case in found.cases + found.shared} | {failure.backend for failure in found.failures}


@pytest.mark.parametrize("question", slow_beyond([DISTANCE, NEAR, IMPACT]), ids=lambda question: question.query)
@pytest.mark.parametrize("shape", [pytest.param("sphere", marks=pytest.mark.slow), "hull"])
def test_honest_methods_are_not_accused(question, shape):
    found = compare([crowd(question, shape)], HONEST)
    assert (named(found), found.unsupported) == (set(), [])
    (tally,) = found.tallies
    assert (tally.query, tally.verdicts) == (question.query, tally.poses * 66)
    assert tally.agree == tally.verdicts
    assert found.checked[0].verdicts > 0


@pytest.mark.parametrize("query", ["distance", pytest.param("impact", marks=pytest.mark.slow)])
def test_who_is_asked_for_little_accuracy_owes_no_more(query, liar):
    """A tolerance of an experiment is no claim of a method's; what is off by more is found."""
    coarse = Question(query, 0.2, tolerance=2e-2)
    found = compare([crowd(coarse)], HONEST)
    assert (named(found), found.tallies[0].agree) == (set(), found.tallies[0].verdicts)
    assert compare(
        [crowd(coarse)], ("fcl/grid", liar("loses-near-pairs" if query == "distance" else "misses-hits"))
    ).cases


@pytest.mark.parametrize("name", slow_beyond(POINT_LIARS))
def test_nearest_points_that_are_none_are_a_finding_of_a_gap_that_is_right(name, liar):
    found = compare([crowd(DISTANCE)], ("fcl/grid", liar(name)))
    assert (named(found), found.cases, found.tallies[0].real) == ({name}, [], 0)
    first = found.failures[0]
    assert (first.kind, first.query_index, len(first.bodies)) == ("nearest points", 1, 2)
    assert first.sentence.startswith(f"{name} is wrong at frame 0 (call 1): its nearest points of bodies")
    assert not found.passed


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in QUERY_LIARS]
)
def test_a_liar_is_caught_and_nobody_else_is_accused(name, liar):
    question = DISTANCE if name in ("gaps-too-wide", "loses-near-pairs") else IMPACT
    found = compare([crowd(question)], ("fcl", liar(name)))
    assert named(found) == {name}
    assert not found.passed
    case = found.cases[0]
    errors = {one.error for one in found.cases}
    kind = {"gaps-too-wide": "too wide", "late": "late", "early": "early"}.get(name, "missed")
    assert kind in errors
    assert errors <= {kind, "missed"}
    assert (case.question, case.backends) == (question, ("fcl", name))
    if name == "early":
        assert not case.judgement.touching  # apart when it says that they touch
        assert case.moment == case.told
    elif question is IMPACT:
        assert case.judgement.touching  # before it says so, if it does
        assert case.moment < case.told
    else:
        assert case.judgement.certificate["lower"] <= case.judgement.gap <= case.judgement.certificate["upper"]


def test_what_touches_when_a_frame_begins_is_not_asked_about():
    """Cubes that overlap at first: nothing is said of them until they have parted, so that nobody misses a hit."""
    bodies = make_bodies([[0, 0, 0], [0.3, 0, 0]], [[0, 0, 0], [1, 0, 0]])
    scene = Scene("hull", (cube_mesh(),), bodies, Box(np.full(3, 9.0)))
    found = compare([flown(scene, 3, 0.5, IMPACT)], HONEST)
    assert named(found) == set()


def test_a_time_of_impact_has_its_closed_form():
    """Cubes of side 1/√3 whose faces meet: at rest, and 1 m/s from 1 m away, so that they touch at 1 - 1/√3 s."""
    bodies = make_bodies([[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [-1, 0, 0]])
    scene = Scene("hull", (cube_mesh(),), bodies, Box(np.full(3, 9.0)))
    (frame,) = flown(scene, 1, 0.5, IMPACT).poses(scene)
    late = Frame(*(getattr(frame, name) for name in ("name", "positions", "quaternions", "velocities", "spins")), 0.5)
    for asked in (frame, late):
        assert abs(asked.at(scene, 1 - 1 / np.sqrt(3)).positions[1, 0] - 1 / np.sqrt(3)) < 1e-15
    found = compare([PoseSet(scene, lambda held: (frame, late), question=IMPACT)], HONEST)
    assert (named(found), found.tallies[0].agree) == (set(), 2)


@pytest.mark.slow
@pytest.mark.parametrize("question", [DISTANCE, NEAR, IMPACT], ids=lambda question: question.query)
def test_hard_poses_of_hulls_accuse_no_kernel(question):
    found = compare(hard_questions("hull", (cube_mesh(),), 29, question, 1.0), HONEST)
    assert named(found) == set()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "query", "within"), [("gaps-too-wide", "distance", 0.3), ("late", "impact", None)])
def test_a_saved_disagreement_shows_the_same_again(name, query, within, liar, tmp_path, capsys):
    path = tmp_path / "crowd.yaml"
    engine = f"{{query: {query}{'' if within is None else f', within: {within}'}}}"
    path.write_text(
        "title: Crowd\nscene: {shape: hull, mesh: cube.ply, box: [9, 9, 9], bodies: [{position: [0, 0, 0]}, "
        "{position: [0.8, 0.1, 0.05], velocity: [-1, 0, 0], spin: [0, 0.25, 0]}, {position: [3, 0, 0]}]}\n"
        f"motion: {{duration: 0.5, dt: 1/2, response: none}}\nengine: {engine}\n"
    )
    arguments = ["--backends", f"fcl,{liar(name)}", "--save", str(tmp_path), "--json"]
    assert main(["compare", str(path), *arguments]) == 1
    document = json.loads(capsys.readouterr().out)
    (pair,) = document["pairs"]
    assert (pair["query"], pair["real"]) == (query, len(document["cases"]))
    files = [case["file"] for case in document["cases"]]
    assert files
    assert None not in files
    for case, file in zip(document["cases"], files, strict=True):
        assert (case["query"], case.get("within"), case["wrong"]) == (query, within, name)
        saved = yaml.safe_load(Path(file).read_text(encoding="utf-8"))
        assert (saved["engine"]["query"], saved["engine"].get("within")) == (query, within)
        assert len(saved["scene"]["bodies"]) == 2
        assert main(["compare", file, "--json"]) == 1
        again = json.loads(capsys.readouterr().out)["cases"]
        assert [one["wrong"] for one in again] == [name]
        assert main(["compare", file]) == 1
        assert f"{name} is wrong about {query} " in capsys.readouterr().out


def test_budget_and_every_are_said_with_the_question(tmp_path, capsys):
    path = tmp_path / "near.yaml"
    path.write_text(
        "title: Near\nscene: {shape: sphere, count: 5, box: [4, 4, 4]}\n"
        "motion: {duration: 1, dt: 1/10, response: none}\n"
        "engine: {query: distance, within: 0.5}\nzip: [{algorithm: [grid, brute-force]}]\n"
    )
    assert main(["compare", str(path), "--every", "5", "--budget", "1e-6", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["left_out"][0] == "of the poses of each scene one in 5 was asked about"
    assert "distance within 0.5 m, 5 bodies, shape sphere: not asked, 1e-06 s were spent" in document["left_out"]


@pytest.mark.slow
def test_a_method_that_cannot_be_asked_is_named(tmp_path, capsys):
    path = tmp_path / "hit.yaml"
    path.write_text(
        "title: Hit\nscene: {shape: sphere, count: 3, box: [4, 4, 4]}\n"
        "motion: {duration: 0.1, dt: 1/10, response: none}\n"
        "engine: {query: impact}\n"
    )
    assert main(["compare", str(path), "--backends", "fcl,pybullet", "--json"]) == 0
    (line,) = json.loads(capsys.readouterr().out)["unsupported"]
    assert 'backend "pybullet" cannot be asked query impact' in line
    collision = tmp_path / "collision.yaml"
    collision.write_text(path.read_text().replace("engine: {query: impact}\n", ""))
    assert main(["compare", str(collision), "--backends", "fcl,fcl/native"]) == 2
    assert "fcl cannot be asked query collision with algorithm native" in capsys.readouterr().err
