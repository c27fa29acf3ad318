"""A comparison that is to end early says what it left out."""

import time

from harness.compare.budget import Budget
from harness.compare.comparison import compare
from harness.compare.poses import flown
from tests.compare.test_comparison import compared, written
from tests.conftest import random_scene


def test_every_third_pose_is_asked_of_both(tmp_path):
    scene = random_scene("sphere", 4, 3.0)
    (tally,) = compare([flown(scene, 9, 0.1)], ["fcl", "pybullet"], budget=Budget(every=3)).tallies
    assert (tally.poses, tally.verdicts) == (4, 24)


def test_without_time_nothing_is_asked_and_all_of_it_is_told():
    budget = Budget(1e-9)
    found = compare([flown(random_scene("sphere", 4, 3.0), 9, 0.1)], ["fcl", "pybullet"], budget=budget)
    assert (found.tallies, found.passed) == ([], True)
    assert budget.left_out == ["4 bodies, shape sphere: not asked, 1e-09 s were spent"]


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


def test_json_says_what_was_left_out(tmp_path, capsys):
    code, document = compared(capsys, written(tmp_path, "sphere"), "--budget", "1e-6", "--every", "2")
    assert code == 0
    assert document["left_out"][0] == "of the poses of each scene one in 2 was asked about"
    assert "20 bodies, shape sphere: not asked, 1e-06 s were spent" in document["left_out"]
