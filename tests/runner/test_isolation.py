"""A run that goes wrong costs itself only, and its row says what happened."""

import os
import time
from pathlib import Path

import pytest

from harness.runner.servers import Servers, task_of


def run_one(experiment, servers):
    return servers.run(*task_of(experiment, experiment.points[0], {}))


@pytest.mark.parametrize(
    ("body", "status", "reason"),
    [
        ("ctypes.string_at(0)", "crashed", "signal 11 (SIGSEGV)"),
        ("os.abort()", "crashed", "signal 6 (SIGABRT)"),
        ("os._exit(3)", "crashed", "exit code 3"),
        ("raise RuntimeError('no luck')", "failed", "RuntimeError: no luck"),
        ("sys.exit(4)", "failed", "SystemExit: 4"),
        ("time.sleep(60)", "timeout", "did not end within 1 s"),
        ("block = bytearray(8 << 30)", "memory", "needed more than 1 GiB"),
        ("os.kill(os.getpid(), 9)", "memory", "killed by the system"),
    ],
)
def test_each_way_to_go_wrong_has_its_status(spheres, plugin, body, status, reason):
    plugin("bad", body)
    experiment = spheres(backend="bad", algorithm="native", timeout=1 if status == "timeout" else 20, memory="1GiB")
    with Servers() as servers:
        report = run_one(experiment, servers)
        assert report.status == status, report
        assert reason in report.reason
        assert run_one(spheres(), servers).status == "ok"


def test_what_a_backend_prints_goes_to_its_row_and_nowhere_else(spheres, plugin, capfd):
    plugin("loud", "print('garbage ' * 3); os.write(2, b'more'); raise ValueError('stop')")
    with Servers() as servers:
        report = run_one(spheres(backend="loud", algorithm="native"), servers)
    assert "more" in report.stderr
    assert "ValueError: stop" in report.stderr
    assert capfd.readouterr() == ("", "")


def test_everything_a_run_started_ends_with_it(spheres, plugin, tmp_path):
    note = tmp_path / "grandchild"
    plugin(
        "forks", f"child = os.fork()\nif child == 0:\n    time.sleep(60)\nopen({str(note)!r}, 'w').write(str(child))"
    )
    with Servers() as servers:
        assert run_one(spheres(backend="forks", algorithm="native"), servers).status == "ok"
    state = Path(f"/proc/{note.read_text()}/stat")
    deadline = time.monotonic() + 5
    while state.exists() and state.read_text().split()[2] != "Z" and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not state.exists() or state.read_text().split()[2] == "Z"


def test_leaving_the_servers_ends_them(spheres):
    with Servers() as servers:
        run_one(spheres(), servers)
        (server,) = servers._servers.values()
        process = server._process.pid
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_a_placement_that_cannot_fit_is_rejected_with_the_numbers(spheres):
    with Servers() as servers:
        report = run_one(spheres(count=500), servers)
    assert report.status == "rejected"
    assert "overlap" in report.reason


def test_a_scene_beyond_the_memory_is_refused_before_anything_is_allocated(spheres):
    with Servers() as servers:
        report = run_one(spheres(count=10**9), servers)
    assert report.status == "rejected"
    assert "GiB" in report.reason
