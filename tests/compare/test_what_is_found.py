"""What a comparison counts beside disagreements: shared errors, approximations, gaps, flights; and what it keeps."""

import json

import numpy as np
import pytest

from harness.cli.main import main
from harness.compare.comparison import compare, disagreements
from harness.compare.cross_section import cross_section
from harness.compare.free_running import run_both
from harness.compare.hard_poses import hard_poses
from harness.compare.judge import judge, touches
from harness.compare.minimise import minimise
from harness.compare.outcome import Case
from harness.compare.poses import Pose, PoseSet, flown
from harness.compare.tally import Approximation, GapHistogram, decade_of
from harness.scene.box import Box
from harness.scene.scene import Scene
from harness.store import tables
from tests.conftest import cube_mesh, make_bodies, random_scene


def two_spheres(path, duration):
    path.write_text(
        "title: Two\n"
        "scene: {shape: sphere, box: [4, 4, 4], bodies: [{position: [0, 0, 0]}, {position: [0.5, 0, 0]}]}\n"
        f"motion: {{duration: {duration}, dt: 1/30, response: none}}\n"
    )
    return str(path)


def at_rest(scene):
    pose = Pose("here", scene.bodies.positions, scene.bodies.quaternions)
    return PoseSet(scene, lambda held: (pose,), hard=True)


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_the_short_verdict_is_that_of_the_judge(shape):
    for pose_set in list(hard_poses(shape, cube_mesh(), 31))[::3]:
        for pose in pose_set.poses(pose_set.scene):
            truth = judge(pose_set.scene, 0, 1, pose.positions, pose.quaternions)
            assert touches(pose_set.scene, 0, 1, pose.positions, pose.quaternions) == truth.touching


def test_two_that_are_wrong_together_are_found_by_the_judge(defective):
    names = (defective("blind"), defective("blind-too"))
    scene = Scene("hull", cube_mesh(), make_bodies([[0, 0, 0], [0.3, 0, 0]]), Box(np.full(3, 2.0)))
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


def test_a_hull_for_a_mesh_is_measured_in_false_hits_and_misses():
    # a small one inside a large one touches its hull, but not its surface
    bodies = make_bodies([[0, 0, 0], [0.02, 0, 0], [2, 0, 0], [2.3, 0, 0]], sizes=[1.0, 0.2, 1.0, 1.0])
    scene = Scene("mesh", cube_mesh(), bodies, Box(np.full(3, 4.0)))
    found = compare([flown(scene, 0, 1.0)], ("fcl", "pybullet"))
    (one,) = found.approximations
    assert (one.backend, one.verdicts) == ("pybullet", 6)
    assert (one.reported, one.touching, one.false_hits, one.contained, one.misses) == (2, 1, 1, 1, 0)
    assert one.false_share == 0.5
    assert Approximation(("a", "b"), "mesh", "b").missed_share == 0.0


def test_gaps_are_counted_by_their_decade():
    assert [decade_of(gap) for gap in (0.0, 5e-17, 2e-15, 1e-15, -3e-3, 0.5, -7.0)] == [0, 0, 2, 2, -14, 16, -16]
    axis, other = GapHistogram(("a", "b"), "hull"), GapHistogram(("a", "b"), "hull")
    axis.count("real", 1e-3)
    other.count("real", 2e-3)
    other.count("undecided", -1e-12)
    axis.add(other)
    assert axis.counts == {"real": {14: 2}, "undecided": {-5: 1}}


def test_flights_of_equal_backends_never_part_and_those_of_a_blind_one_do_at_its_first_miss(defective):
    scene = random_scene("sphere", 12, 4.0, seed=3)
    how = {"frames": 60, "dt": 1 / 30, "response": "elastic"}
    (same,) = run_both(scene, ("fcl", "pybullet"), **how).flights
    assert same.diverged is None
    assert same.shared_hits > 0
    assert same.afterwards[0].pair_hits_per_second == same.afterwards[1].pair_hits_per_second > 0
    (other,) = run_both(scene, ("fcl", defective("blind")), **how).flights
    assert 0 < other.diverged <= 2.0
    seeing, blind = other.afterwards
    assert seeing.pair_hits_per_second > 0 == blind.pair_hits_per_second
    assert abs(seeing.energy_change) < 1e-12


def test_a_flight_that_crashes_is_a_failure_at_its_frame(defective):
    scene = random_scene("sphere", 4, 3.0, seed=2)
    scene.bodies.positions[0] = [-1.0, 0.0, 0.0]
    found = run_both(scene, ("fcl", defective("crashes")), frames=3, dt=0.01, response="reflect")
    assert [(failure.backend, failure.query_index) for failure in found.failures] == [("crashes", 1)]
    assert "SIGSEGV" in found.failures[0].reason


def test_a_defect_that_needs_many_bodies_is_reduced_to_those_it_needs(defective):
    name = defective("swaps")
    positions = [[0, 0, 0], [2, 0, 0], *([k, 3.0, 0] for k in range(4)), [0.4, 0.2, 0.1]]
    scene = Scene("hull", cube_mesh(), make_bodies(positions), Box(np.full(3, 20.0)))
    (case, *_) = disagreements(scene, Pose("here", scene.bodies.positions, scene.bodies.quaternions), ("fcl", name))
    small = minimise(case)
    assert len(small.scene.bodies) == 3
    assert (small.scene.bodies.positions == small.scene.bodies.positions.round(1)).all()


def test_a_defect_that_depends_on_order_is_reported_with_frame_and_question(defective, tmp_path, capsys):
    path = two_spheres(tmp_path / "rare.yaml", 40)
    names = f"fcl,{defective('drops')}"
    assert main(["compare", path, "--backends", names, "--save", str(tmp_path), "--json"]) == 1
    said = capsys.readouterr()
    (case,) = json.loads(said.out)["cases"]
    assert (case["wrong"], case["file"], case["depends_on_order"]) == ("drops", None, True)
    assert (case["certificate"]["pose"], case["certificate"]["call"]) == ("frame 999", 1000)
    assert "frame 999, call 1000: it depends on what was asked before" in said.err


def test_a_section_cuts_both_bodies_where_they_meet():
    scene = Scene("hull", cube_mesh(), make_bodies([[0, 0, 0], [0.7, 0, 0]]), Box(np.full(3, 2.0)))
    pose = Pose("here", scene.bodies.positions, scene.bodies.quaternions)
    case = Case(("a", "b"), "b", (0, 1), judge(scene, 0, 1, pose.positions, pose.quaternions), scene, pose, 1)
    first, second = (np.array(cut) for cut in cross_section(case))
    half = 1 / np.sqrt(12)
    assert np.abs(first[:, [0, 2]] + 0.35).max() == pytest.approx(half, abs=1e-4)
    assert np.abs(second[:, [0, 2]] - 0.35).max() == pytest.approx(half, abs=1e-4)


def test_verdicts_are_kept_where_db_says_and_the_newest_count(defective, tmp_path, capsys):
    path = two_spheres(tmp_path / "two.yaml", 0)
    database = tmp_path / "kept.db"
    names = f"fcl,{defective('blind')}"
    for _ in range(2):
        assert main(["compare", path, "--backends", names, "--db", str(database)]) == 1
    (record,) = tables.comparisons(database)
    assert (record.experiment, record.backends) == ("two", ("fcl", "blind"))
    (shown,) = record.document["shown"]
    assert shown["minimised"]["gap"] < 0
    assert shown["text"].startswith("#")
    assert len(shown["section"]) == 2


def test_a_sweep_compares_what_asks_for_it_once(tmp_path, capsys):
    path = tmp_path / "asked.yaml"
    path.write_text(
        "title: Asked\nscene: {shape: sphere, count: 5, box: [4, 4, 4]}\n"
        "motion: {duration: 0.1, dt: 1/30, response: none}\n"
        "zip: [{backend: [fcl, pybullet], algorithm: [grid, native]}]\nmeasure: {repeats: 1, compare: on}\n"
    )
    assert main(["sweep", str(path), "--db", "results.db"]) == 0
    assert "asked: fcl and pybullet: " in capsys.readouterr().out
    (record,) = tables.comparisons("results.db")
    (pair,) = record.document["pairs"]
    assert pair["verdicts"] == pair["agree"] + pair["undecided"] > 4 * 10
    assert main(["sweep", str(path), "--db", "results.db"]) == 0
    assert "asked: fcl and pybullet" not in capsys.readouterr().out
    assert tables.comparisons("results.db") == [record]
