"""A run that goes wrong costs itself only, and its row says what happened."""

import os
import textwrap
import time

import psutil
import pytest

from harness.measure.conditions import CONDITIONS
from harness.runner.servers import Servers, task_of
from tests.runner.conftest import install_plugin

# A backend that fails in another way with every number of bodies: what it does, and the status and reason reported.
FAILURES = {
    2: ("ctypes.string_at(0)", "crashed", "signal 11 (SIGSEGV)"),
    3: ("os.abort()", "crashed", "signal 6 (SIGABRT)"),
    4: ("os._exit(3)", "crashed", "exit code 3"),
    5: ("raise RuntimeError('no luck')", "failed", "RuntimeError: no luck"),
    6: ("sys.exit(4)", "failed", "SystemExit: 4"),
    7: ("time.sleep(60)", "timeout", "did not end within 1 s"),
    8: ("block = bytearray(8 << 30)", "memory", "needed more than 1 GiB"),
    9: ("os.kill(os.getpid(), 9)", "memory", "killed by the system"),
}

# And what it does besides, each with a test of its own.
LOUD, SCRIBBLES, TELLS = 10, 11, 12
BESIDES = {
    LOUD: "print('garbage ' * 3); os.write(2, b'more'); raise ValueError('stop')",
    SCRIBBLES: "for n in range(3, 64):\n    try: os.write(n, b'garbage' * 9)\n    except OSError: pass",
    TELLS: "raise ValueError(f\"{len(os.sched_getaffinity(0))} core, {os.environ['OMP_NUM_THREADS']} thread\")",
}
ROOMY = [10, 10, 10]


def run_one(experiment, servers):
    return servers.run(*task_of(experiment, experiment.points[0], {}))


@pytest.fixture(scope="module")
def servers(tmp_path_factory):
    """Servers of several tests, with the backend that goes wrong in all these ways."""
    statements = {count: does for count, (does, *_) in FAILURES.items()} | BESIDES
    body = "\n".join(f"if len(positions) == {n}:\n{textwrap.indent(does, '    ')}" for n, does in statements.items())
    with pytest.MonkeyPatch.context() as patch, Servers() as opened:
        install_plugin(tmp_path_factory.mktemp("ways"), patch, "bad", body)
        yield opened


@pytest.mark.slow
@pytest.mark.parametrize("count", FAILURES)
def test_each_way_to_go_wrong_has_its_status(spheres, servers, count):
    _, status, reason = FAILURES[count]
    timeout = 1 if status == "timeout" else 20
    experiment = spheres(backend="bad", algorithm="native", count=count, box=ROOMY, timeout=timeout, memory="1GiB")
    report = run_one(experiment, servers)
    assert report.status == status, report
    assert reason in report.reason
    assert run_one(spheres(), servers).status == "ok"
    assert run_one(spheres(backend="bad", algorithm="native", count=20, box=ROOMY), servers).status == "ok"


@pytest.mark.slow
def test_what_a_backend_prints_goes_to_its_row_and_nowhere_else(spheres, servers, capfd):
    report = run_one(spheres(backend="bad", algorithm="native", count=LOUD, box=ROOMY), servers)
    assert "more" in report.stderr
    assert "ValueError: stop" in report.stderr
    assert capfd.readouterr() == ("", "")


def ended(process, within=5.0):
    """Whether a process has gone, or goes soon."""
    deadline = time.monotonic() + within
    while psutil.pid_exists(process) and psutil.Process(process).status() != psutil.STATUS_ZOMBIE:
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True


@pytest.mark.slow
@pytest.mark.parametrize("hiding", ["", "os.setsid()", "os.setsid()\n    if os.fork(): os._exit(0)\n    os.setsid()"])
def test_everything_a_run_started_ends_with_it(spheres, plugin, tmp_path, hiding):
    """A child in a session of its own, whose parent has gone, is found all the same."""
    note = tmp_path / "grandchild"
    body = f"""
        if self.calls == 1 and os.fork() == 0:
            {hiding.replace(chr(10), chr(10) + 8 * " ")}
            open({str(note)!r}, "w").write(str(os.getpid()))
            time.sleep(60)
        while not os.path.exists({str(note)!r}) or not open({str(note)!r}).read():
            time.sleep(0.01)
        """
    plugin("forks", body)
    with Servers() as servers:
        assert run_one(spheres(backend="forks", algorithm="native"), servers).status == "ok"
        assert ended(int(note.read_text()))


@pytest.mark.slow
def test_what_a_backend_writes_into_any_file_it_holds_harms_no_other_run(spheres, servers):
    report = run_one(spheres(backend="bad", algorithm="native", count=SCRIBBLES, box=ROOMY), servers)
    assert (report.status, report.reason) == ("crashed", "its report cannot be read")
    assert run_one(spheres(), servers).status == "ok"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("head", "status", "reason"),
    [
        ("ctypes.string_at(0)\n", "crashed", "signal 11"),
        ("time.sleep(60)\n", "timeout", "did not end within 2 s"),
        ("1 / 0\n", "failed", "ZeroDivisionError"),
    ],
)
def test_a_backend_that_cannot_be_imported_costs_its_own_runs_only(spheres, plugin, head, status, reason, monkeypatch):
    monkeypatch.setattr("harness.runner.servers._IMPORT", 2.0)
    plugin("broken", head=head)
    experiment = spheres(backend="broken", algorithm="native", timeout=1 if status == "timeout" else 20)
    with Servers() as servers:
        began = time.monotonic()
        report = run_one(experiment, servers)
        first = time.monotonic() - began
        assert report.status == status, report
        assert reason in report.reason
        began = time.monotonic()
        assert run_one(experiment, servers).status == status
        assert time.monotonic() - began < max(1.0, first)  # it is not tried again and again
        assert run_one(spheres(), servers).status == "ok"


@pytest.mark.slow
def test_importing_a_backend_is_no_part_of_its_runs(spheres, plugin):
    plugin("imported", head="time.sleep(3)\n")
    with Servers() as servers:
        report = run_one(spheres(backend="imported", algorithm="native", timeout=2), servers)
    assert (report.status, report.reason) == ("ok", None)


@pytest.mark.slow
@pytest.mark.parametrize("timeout", [1e7, 1e20, 1e30])
def test_a_limit_longer_than_the_system_can_wait_is_none(spheres, servers, timeout):
    assert run_one(spheres(timeout=timeout), servers).status == "ok"


@pytest.mark.slow
def test_a_run_has_one_thread_and_one_core(spheres, servers):
    experiment = spheres(backend="bad", algorithm="native", count=TELLS, box=ROOMY)
    report = servers.run(*task_of(experiment, experiment.points[0], {}, pinned=True))
    assert report.reason == "ValueError: 1 core, 1 thread"
    assert report.conditions["core"] in os.sched_getaffinity(0)


@pytest.mark.slow
def test_what_a_run_met_is_told(spheres, servers):
    report = run_one(spheres(), servers)
    assert {"load", "seconds", "flights"} <= report.conditions.keys() <= CONDITIONS.keys()
    assert 0.0 < report.conditions["seconds"] < 20.0


@pytest.mark.slow
def test_a_run_costs_less_than_50_ms_beyond_its_own_work(spheres):
    """CPU time of all that surrounds a run that has nothing to do; elapsed time would measure the other load, too."""
    experiment, cost = spheres(count=1, duration="1/60"), []
    with Servers() as servers:
        run_one(experiment, servers)
        (server,) = servers._servers.values()
        process = psutil.Process(server._process.pid)
        for _ in range(20):
            before = process.cpu_times()
            run_one(experiment, servers)
            after = process.cpu_times()
            cost.append(sum(after[:4]) - sum(before[:4]))  # the server's and its children's
    assert min(cost) < 0.05  # the others met the other load


@pytest.mark.slow
def test_leaving_the_servers_ends_them(spheres):
    with Servers() as servers:
        run_one(spheres(), servers)
        (server,) = servers._servers.values()
        process = server._process.pid
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


@pytest.mark.slow
def test_a_placement_that_cannot_fit_is_rejected_with_the_numbers(spheres, servers):
    report = run_one(spheres(count=500), servers)
    assert report.status == "rejected"
    assert "overlap" in report.reason


@pytest.mark.slow
def test_a_scene_beyond_the_memory_is_refused_before_anything_is_allocated(spheres, servers):
    report = run_one(spheres(count=10**9), servers)
    assert report.status == "rejected"
    assert "GiB" in report.reason
