"""A backend in a process of its own: its answers are checked, and its process ends with all that it started."""

import time

import numpy as np
import psutil
import pytest

from harness.compare.isolated import Isolated, UnusableError
from harness.compare.poses import flown
from tests.conftest import random_scene


def test_an_answer_that_is_none_is_a_failure_at_its_pose():
    scene = random_scene("sphere", 3, 3.0)
    pose_set = flown(scene, 0, 1.0)
    (pose,) = pose_set.poses(scene)
    with Isolated("fcl", scene) as asked:
        broken = type(pose)("nowhere", np.full((3, 3), np.nan), pose.quaternions)
        assert "not finite" in asked.pairs(broken)
        assert not isinstance(asked.pairs(pose), str)


def ended(process, within=5.0):
    """Whether a process has gone, or goes soon."""
    deadline = time.monotonic() + within
    while psutil.pid_exists(process) and psutil.Process(process).status() != psutil.STATUS_ZOMBIE:
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True


def test_what_a_backend_started_ends_with_it_also_in_a_session_of_its_own(defective, tmp_path, monkeypatch):
    note = tmp_path / "started"
    monkeypatch.setenv("HARNESS_TEST_NOTE", str(note))
    scene = random_scene("sphere", 3, 3.0)
    with Isolated(defective("forks"), scene) as asked:
        (pose,) = flown(scene, 0, 1.0).poses(scene)
        assert not isinstance(asked.pairs(pose), str)
        started = int(note.read_text())
        assert psutil.pid_exists(started)
    assert ended(started)


def test_a_backend_that_cannot_load_again_fails_at_its_poses_and_harms_no_other(defective, tmp_path, monkeypatch):
    monkeypatch.setenv("HARNESS_TEST_NOTE", str(tmp_path / "loaded"))
    scene = random_scene("sphere", 3, 3.0)
    (pose,) = flown(scene, 0, 1.0).poses(scene)
    with Isolated(defective("loads-once"), scene) as asked:
        assert "SIGSEGV" in asked.pairs(pose)
        assert asked.pairs(pose) == "RuntimeError: loaded before"
        with pytest.raises(UnusableError, match="loaded before"), Isolated("loads-once", scene):
            pass


def test_what_a_backend_prints_and_writes_is_not_heard(defective, capfd):
    scene = random_scene("sphere", 3, 3.0)
    (pose,) = flown(scene, 0, 1.0).poses(scene)
    with Isolated(defective("prints"), scene) as asked:
        assert not isinstance(asked.pairs(pose), str)
    assert capfd.readouterr() == ("", "")
