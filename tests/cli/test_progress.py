"""The progress of a sweep on standard error: plain lines without a terminal, and never while something is timed."""

import io

import pytest
from rich.console import Console

from harness.cli.main import main
from harness.cli.progress import Progress, name_of
from harness.experiment.load import load_text
from harness.runner.estimate import Estimate, duration_text
from harness.runner.schedule import Job
from harness.runner.task import Report

EXPERIMENT = """
title: Progress
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.2}
sweep: {count: [2, 500]}
measure: {repeats: 1}
"""


@pytest.fixture
def swept(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.yaml").write_text(EXPERIMENT)

    def sweep(*words):
        assert main(["sweep", "p.yaml", "--fresh", *words]) == 1
        return capsys.readouterr()

    return sweep


@pytest.mark.slow
def test_without_a_terminal_there_are_plain_lines_and_failures_as_they_happen(swept):
    output = swept()
    first, failure = output.err.splitlines()
    assert first == "2 runs to do"
    assert failure.startswith("p (count 500, repeat 0): rejected: ")
    assert "\x1b" not in output.err + output.out
    table = output.out.splitlines()[:2]
    assert table[0].split() == ["experiment", "runs", "failed", "time"]
    assert table[1].split()[:4] == ["p", "2", "1", "rejected"]


@pytest.mark.slow
def test_quiet_says_only_what_goes_wrong_and_verbose_a_line_a_run(swept):
    quiet = swept("--quiet")
    assert [line.split(":")[0] for line in quiet.err.splitlines()] == ["p (count 500, repeat 0)"]
    assert "experiment  " not in quiet.out
    verbose = swept("--verbose")
    assert any(line.startswith("p (count 2, repeat 0): ok, ") for line in verbose.err.splitlines())


class Terminal(Console):
    """A console that takes itself for a terminal and keeps what is drawn."""

    def __init__(self, **_):
        super().__init__(force_terminal=True, width=100, record=True, file=io.StringIO())


def test_on_a_terminal_sweep_and_run_are_drawn_between_runs_only(monkeypatch, tmp_path):
    monkeypatch.setattr("rich.console.Console", Terminal)
    monkeypatch.setattr("harness.cli.progress._DRAW_EVERY", 0.0)
    experiment = load_text(EXPERIMENT, tmp_path / "p.yaml", {})
    jobs = [Job(experiment, point, str(place), 0) for place, point in enumerate(experiment.points)]
    estimate = Estimate({"0": 40.0, "1": 80.0}, {"0": {}, "1": {}})
    with Progress() as progress:
        assert not progress._bars.live.auto_refresh  # no thread of its own draws
        progress.begin(jobs, estimate)
        progress._next = 0.0
        progress.before(jobs[0])
        drawn = progress._console.export_text()
        assert "0 of 2, 2 min left" in drawn
        assert "about 40 s" in drawn
        assert name_of(jobs[0]) in drawn
        progress.after(jobs[0], Report("ok", None))
        assert "1 of 2, 80 s left" in progress._console.export_text()


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.04, "0.0 s"), (2.6, "3 s"), (99, "99 s"), (700, "12 min"), (12000, "3 h 20 min")]
)
def test_times_are_said_as_people_say_them(seconds, words):
    assert duration_text(seconds) == words
