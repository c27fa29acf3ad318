"""The real command, killed and interrupted: nothing finished is lost or left running, and the next does the rest."""

import os
import signal

import psutil
import pytest

from tests.runner.kill_sweep import Killed


@pytest.fixture
def killed(tmp_path):
    sweep = Killed(tmp_path, repeats=8)
    yield sweep
    for process in sweep.processes():
        process.kill()


@pytest.mark.slow
def test_a_sweep_killed_at_random_moments_loses_nothing_and_leaves_no_process(killed):
    """A short form of the script `kill_sweep.py`."""
    for _ in range(3):
        kept = killed.kill_once()
    assert f"{16 - kept} runs done ({16 - kept} ok), {kept} kept" in killed.finish()
    assert killed.all_gone()


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [[], ["--jobs", "2"]])
def test_ctrl_c_ends_every_process_keeps_what_is_done_and_says_how_to_go_on(killed, jobs):
    sweep = killed.start(*jobs)
    lines = []
    while not lines or "): ok" not in lines[-1] or "control" in lines[-1]:
        lines.append(sweep.stderr.readline())
    assert psutil.Process(sweep.pid).children()
    os.killpg(sweep.pid, signal.SIGINT)  # to the whole group, as a terminal does
    rest = sweep.stderr.read()
    sweep.communicate()
    assert sweep.returncode == 130
    assert "every finished run is kept. To go on: harness sweep kill.yaml --db kill.db" in rest
    assert "Traceback" not in rest
    assert killed.all_gone()
    assert killed.check() >= 1
