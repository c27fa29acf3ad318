"""The same runs on the workers of a real Dask scheduler: the same counters, whatever happens to a worker."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import psutil
import pytest

from harness.cli.main import main
from harness.measure.metrics import METRICS
from harness.store import tables


@pytest.fixture(autouse=True)
def distributed():
    """It takes a second and a half to import, so that only who runs these tests does."""
    pytest.importorskip("distributed")


EXPERIMENT = """
title: On a cluster
scene: {mesh: cube.ply, shape: hull, count: 6, box: [6, 6, 6]}
motion: {duration: 1}
sweep: {count: [4, 8, 16]}
measure: {repeats: 2}
"""


class LocalScheduler:
    """A scheduler and workers, each a process of its own, as on a cluster. A context."""

    def __init__(self, folder, workers=2):
        self._folder, self._count, self._open = folder, workers, ExitStack()

    def __enter__(self):
        file = self._folder / "scheduler.json"
        self.scheduler = self._start("scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))
        deadline = time.monotonic() + 30
        while not file.exists() or not file.read_text():
            assert time.monotonic() < deadline, "no scheduler"
            time.sleep(0.05)
        self.address = json.loads(file.read_text())["address"]
        self.workers = [
            self._start("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
            for _ in range(self._count)
        ]
        return self

    def __exit__(self, *_):
        self._open.close()

    def _start(self, *words):
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", *words],
            cwd=self._folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self._open.callback(process.wait)
        self._open.callback(process.kill)
        return process


@pytest.fixture
def small(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(EXPERIMENT)
    return tmp_path


def counted(database):
    """Everything exact that a sweep has measured, by experiment, point and repeat."""
    exact = [name for name, metric in METRICS.items() if not metric.noisy]
    return {
        (run.experiment, run.point, run.repeat): {name: run.metrics[name] for name in exact if name in run.metrics}
        for run in tables.run_records(database)
    }


@pytest.mark.slow
def test_a_cluster_counts_what_one_machine_counts_to_the_bit_even_if_a_worker_dies(small, plugin, capfd):
    """One of the two workers is killed by a run that it has in hand; its runs are done by the other."""
    plugin(
        "kills",
        f"""
        note = {str(small / "killed")!r}
        if not os.path.exists(note):
            open(note, "w").write("")
            server = os.getppid()
            worker = int(open(f"/proc/{{server}}/stat").read().split()[3])
            os.kill(worker, signal.SIGKILL)
            time.sleep(30)
        """,
    )
    (small / "kills.yaml").write_text(EXPERIMENT.split("zip")[0] + "engine: {backend: kills, algorithm: native}\n")
    with LocalScheduler(small) as cluster:
        assert main(["sweep", "kills.yaml", "small.yaml", "--db", "cluster.db", "--cluster", cluster.address]) == 0
        dead = [worker for worker in cluster.workers if worker.poll() is not None]
        assert [worker.returncode for worker in dead] == [-signal.SIGKILL]
    assert (small / "killed").exists()
    assert main(["sweep", "kills.yaml", "small.yaml", "--db", "alone.db"]) == 0
    assert counted("cluster.db") == counted("alone.db") != {}

    together, alone = tables.runs("cluster.db"), tables.runs("alone.db")
    assert not together["timing_grade"].any()  # two workers share this machine
    assert alone["timing_grade"].all()
    assert set(together["machine"]).isdisjoint(alone["machine"])  # times of the two are never paired
    facts = tables.machines("cluster.db")
    assert {facts[machine]["host"] for machine in together["machine"]} == {os.uname().nodename}


@pytest.mark.slow
def test_a_scheduler_that_dies_ends_the_sweep_with_a_sentence_and_the_next_does_the_rest(
    small, plugin, capfd, monkeypatch
):
    """It is killed by a run, so that others are done and kept before."""
    monkeypatch.setattr("harness.runner.cluster.CONNECT_TIMEOUT", 3.0)
    scheduler = str(small / "scheduler")
    plugin(
        "parts",
        f"""
        if self.calls == 1 and len(os.listdir({str(small / "marks")!r})) == 3 and os.path.exists({scheduler!r}):
            process = int(open({scheduler!r}).read())
            os.remove({scheduler!r})  # at once: a worker may end this run before it leaves its own mark
            os.kill(process, signal.SIGKILL)
        if self.calls == 1:
            open(f"{small / "marks"}/{{os.getpid()}}", "w").close()
        """,
    )
    (small / "marks").mkdir()
    (small / "parts.yaml").write_text(EXPERIMENT + "engine: {backend: parts, algorithm: native}\n")
    with LocalScheduler(small, workers=1) as cluster:
        Path(scheduler).write_text(str(cluster.scheduler.pid))
        assert main(["sweep", "parts.yaml", "--db", "parts.db", "--cluster", cluster.address]) == 2
    said = capfd.readouterr().err
    assert "the connection to the scheduler was lost; every finished run is kept" in said
    assert "Traceback" not in said
    kept = len(counted("parts.db"))
    assert kept < 6
    assert main(["sweep", "parts.yaml", "--db", "parts.db"]) == 0
    assert f"{6 - kept} runs done ({6 - kept} ok), {kept} kept from before" in capfd.readouterr().out


@pytest.mark.slow
def test_jobs_is_the_same_path_on_this_machine_and_leaves_nothing_running(small):
    before = psutil.Process().children(recursive=True)  # other tests may have left servers of theirs
    assert main(["sweep", "small.yaml", "--db", "two.db", "--jobs", "2"]) == 0
    assert len(counted("two.db")) == 6
    children = psutil.Process().children(recursive=True)
    left = [" ".join(child.cmdline()) for child in children if child not in before]
    assert not any("harness.runner.server" in command for command in left)


@pytest.mark.slow
def test_a_worker_with_other_sources_is_refused_before_any_run(small, capsys, monkeypatch):
    monkeypatch.setattr("harness.runner.cluster.sources_hash", lambda: "0" * 64)
    assert main(["sweep", "small.yaml", "--db", "other.db", "--cluster", "local:1"]) == 2
    assert "runs another version of harness" in capsys.readouterr().err
    assert len(tables.runs("other.db")) == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--cluster", "tcp://127.0.0.1:9"], "no scheduler answers"),
        (["--cluster", "nowhere"], "must be tcp://HOST:PORT or local:N"),
        (["--jobs", "0"], "it must be a whole number, 1 or more"),
    ],
)
def test_a_cluster_that_is_not_there_is_a_sentence(small, capsys, monkeypatch, words, said):
    monkeypatch.setattr("harness.runner.cluster.CONNECT_TIMEOUT", 0.5)
    assert exit_code(["sweep", "small.yaml", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_without_the_extra_the_command_to_install_it_is_said(small, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["sweep", "small.yaml", "--jobs", "2"]) == 2
    assert "pip install 'harness[cluster]'" in capsys.readouterr().err


@pytest.mark.slow
def test_workers_that_cannot_be_started_are_a_sentence(small, capsys, monkeypatch):
    def refuse(**_):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr("distributed.LocalCluster", refuse)
    assert main(["sweep", "small.yaml", "--jobs", "2"]) == 2
    assert "local:2: the workers cannot be started: Nanny failed to start." in capsys.readouterr().err


def test_too_few_open_files_for_dask_are_a_sentence(small, capsys, monkeypatch):
    limits = resource.getrlimit
    few = {resource.RLIMIT_NOFILE: (20, 20)}
    monkeypatch.setattr(resource, "getrlimit", lambda which: few.get(which) or limits(which))
    assert main(["sweep", "small.yaml", "--jobs", "2"]) == 2
    assert "this needs 80 open files, and a process may have 20 here (`ulimit -n`)" in capsys.readouterr().err


def exit_code(words):
    try:
        return main(words)
    except SystemExit as error:  # argparse
        return error.code
