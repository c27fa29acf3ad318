"""A comparison that is to end early says what it left out."""

import time

from harness.compare.atlas import survey
from harness.compare.budget import Budget
from harness.compare.comparison import compare, compare_all
from harness.compare.hard_poses import hard_poses
from harness.compare.poses import flown
from tests.compare.test_comparison import compared, written
from tests.conftest import cube_mesh, needs_pybullet, random_scene


@needs_pybullet
def test_every_third_pose_is_asked_of_both(tmp_path):
    scene = random_scene("sphere", 4, 3.0)
    (tally,) = compare([flown(scene, 9, 0.1)], ["fcl", "pybullet"], budget=Budget(every=3)).tallies
    assert (tally.poses, tally.verdicts) == (4, 24)


def test_without_time_nothing_is_asked_and_all_of_it_is_told():
    budget = Budget(1e-9)
    found = compare([flown(random_scene("sphere", 4, 3.0), 9, 0.1)], ["fcl", "pybullet"], budget=budget)
    assert (found.tallies, found.passed) == ([], True)
    assert budget.left_out == ["4 bodies, shape sphere: not asked, 1e-09 s were spent"]


def test_scenes_that_differ_in_sizes_alone_are_told_of_in_one_line():
    budget = Budget(1e-9)
    compare(hard_poses("sphere", (), 1), ["fcl", "pybullet"], budget=budget)
    (line,) = budget.left_out
    assert line.startswith("2 bodies, shape sphere, sizes 0.3 to 1 m; sizes 1 to 10 m; sizes 1 to 50 m; ")
    assert line.endswith(": not asked, 1e-09 s were spent")


@needs_pybullet
def test_poses_that_several_methods_were_not_asked_about_are_told_of_once():
    class Ending(Budget):
        @property
        def spent(self):
            return asked()

    calls = iter(range(1000))

    def asked():
        return next(calls) > 3

    budget = Ending(1.0)
    compare_all([flown(random_scene("sphere", 4, 3.0), 9, 0.1)], ["fcl", "pybullet", "fcl/grid"], budget=budget)
    (line,) = budget.left_out
    assert line.count("poses") == 1
    assert "not asked about " in line
    assert line.endswith(" of 10 poses of fcl, pybullet, fcl/grid, 1 s were spent")


def test_families_of_which_an_atlas_left_out_as_much_share_a_line():
    budget = Budget(1e-9)
    survey("hull", cube_mesh(), ["random", "sizes"], 8, ["fcl", "fcl/grid"], budget)
    assert budget.left_out == [f"collision, hull of {cube_mesh().name}, random; sizes: not asked, 1e-09 s were spent"]


def test_what_a_pause_takes_does_not_count():
    budget = Budget(0.5)
    with budget.paused():
        time.sleep(0.6)
    assert not budget.spent


def test_a_question_takes_no_more_than_its_share_and_leaves_the_rest_to_the_next():
    budget = Budget(3600.0)
    with budget.share(3600 * 1000):  # a millisecond
        time.sleep(0.01)
        assert budget.spent
        assert budget.why == "its share of 3600 s was spent"
        with budget.paused():
            time.sleep(0.02)
    assert not budget.spent
    with budget.share(1):
        assert not budget.spent
        assert budget.why == "3600 s were spent"


@needs_pybullet
def test_json_says_what_was_left_out(tmp_path, capsys):
    code, document = compared(capsys, written(tmp_path, "sphere"), "--budget", "1e-6", "--every", "2")
    assert code == 0
    assert document["left_out"][0] == "of the poses of each scene one in 2 was asked about"
    assert "20 bodies, shape sphere: not asked, 1e-06 s were spent" in document["left_out"]
