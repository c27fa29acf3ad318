"""A warm server that dies or is stopped costs nothing but time, and leaves nothing behind."""

import resource
import signal
import threading
import time

import psutil
import pytest

from harness.errors import InputError
from harness.runner import servers as rooms
from harness.runner.servers import Servers, task_of
from tests.runner.conftest import install_plugin

ONCE = """
        if self.calls == 1 and not os.path.exists({note!r}):
            open({note!r}, "w").close()
            {does}
        """


@pytest.fixture
def once(tmp_path, monkeypatch, spheres):
    """A run whose backend does something the first time that it is asked, and the servers that run it."""

    def make(does, timeout=20):
        body = ONCE.format(note=str(tmp_path / "note"), does=does)
        install_plugin(tmp_path / "plugins", monkeypatch, "odd", body)
        return spheres(backend="odd", algorithm="native", timeout=timeout)

    return make


def run(servers, experiment):
    return servers.run(*task_of(experiment, experiment.points[0], {}))


@pytest.mark.parametrize("number", ["SIGKILL", "SIGTERM", "SIGSEGV"])
@pytest.mark.slow
def test_the_run_of_a_server_that_dies_is_done_by_another(once, number):
    """Its own run does it to the server here; the second time it finds that it was done."""
    with Servers() as servers:
        report = run(servers, once(f"os.kill(os.getppid(), signal.{number}); time.sleep(60)"))
        assert report.status == "ok"


@pytest.mark.slow
def test_what_the_runs_of_a_dead_server_started_is_ended(once, tmp_path):
    note = tmp_path / "left"
    leaves = f"""
            if os.fork() == 0:
                os.setsid()
                open({str(note)!r}, "w").write(str(os.getpid()))
                time.sleep(600)
            while not os.path.exists({str(note)!r}) or not open({str(note)!r}).read(): time.sleep(0.01)
            os.kill(os.getppid(), 9); time.sleep(60)"""
    with Servers() as servers:
        assert run(servers, once(leaves.strip())).status == "ok"
        left = int(note.read_text())
        assert not psutil.pid_exists(left) or psutil.Process(left).status() == psutil.STATUS_ZOMBIE


@pytest.mark.slow
def test_a_server_that_is_stopped_for_good_is_given_up(once, monkeypatch):
    monkeypatch.setattr(rooms, "_BEYOND", 0.5)
    with Servers() as servers:
        began = time.monotonic()
        report = run(servers, once("os.kill(os.getppid(), signal.SIGSTOP); time.sleep(60)", timeout=3))
        assert report.status == "ok"
        assert time.monotonic() - began > 3.5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "tries", "how"),
    [
        ("SIGKILL", 4, "killed by the system (signal 9), most likely because memory ran out"),
        ("SIGSEGV", 2, "ended by signal 11 (SIGSEGV)"),
    ],
)
def test_a_server_that_is_killed_from_outside_says_less_of_its_run_than_one_that_crashes(
    spheres, plugin, tmp_path, number, tries, how
):
    note = tmp_path / "tries"
    plugin("murders", f"open({str(note)!r}, 'a').write('x'); os.kill(os.getppid(), signal.{number}); time.sleep(60)")
    with Servers() as servers:
        report = run(servers, spheres(backend="murders", algorithm="native"))
        assert (report.status, report.reason) == ("crashed", f'the server of backend "murders" {how}')
        assert note.read_text() == "x" * tries
        assert run(servers, spheres()).status == "ok"


@pytest.fixture
def hit_while_starting(monkeypatch):
    """Sends a signal to that many servers as soon as they are started; returns the servers."""

    def hit(number, most):
        started, found = rooms._Server.start, []

        def start(server, timeout):
            if len(found) < most:
                found.append(server)
                server._process.send_signal(number)
            return started(server, timeout)

        monkeypatch.setattr(rooms._Server, "start", start)
        return found

    return hit


@pytest.mark.slow
def test_servers_killed_while_they_start_are_started_again(spheres, hit_while_starting):
    """Three in a row, as when memory is short: what was no crash of a backend is no reason to give it up."""
    killed = hit_while_starting(signal.SIGKILL, 3)
    with Servers() as servers:
        assert run(servers, spheres()).status == "ok"
    assert len(killed) == 3


@pytest.mark.slow
def test_a_backend_whose_servers_were_killed_is_given_up_for_one_run_only(spheres, hit_while_starting):
    killed = hit_while_starting(signal.SIGTERM, 4)
    with Servers() as servers:
        assert run(servers, spheres()).status == "crashed"
        assert run(servers, spheres()).status == "ok"
    assert len(killed) == 4


@pytest.mark.slow
def test_a_server_is_deaf_to_ctrl_c_from_its_beginning(spheres, hit_while_starting, monkeypatch, capfd):
    monkeypatch.setattr(rooms, "_TRIES", 1)
    hit = hit_while_starting(signal.SIGINT, 1)
    with Servers() as servers:
        assert run(servers, spheres()).status == "ok"
    assert len(hit) == 1
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_a_server_that_died_between_two_runs_costs_the_second_no_try(spheres, monkeypatch):
    monkeypatch.setattr(rooms, "_TRIES_IF_KILLED", 1)
    with Servers() as servers:
        assert run(servers, spheres()).status == "ok"
        (server,) = servers._servers.values()
        server._process.kill()
        server._process.wait()
        assert run(servers, spheres()).status == "ok"


@pytest.mark.slow
def test_interrupted_servers_do_not_try_again(spheres, plugin):
    plugin("waits", "time.sleep(60)")
    with Servers() as servers:

        def interrupt():
            while not any(server._ready for server in servers._servers.values()):
                time.sleep(0.02)
            time.sleep(0.3)
            servers.interrupt()

        thread = threading.Thread(target=interrupt)
        thread.start()
        assert run(servers, spheres(backend="waits", algorithm="native", timeout=50)).status == "crashed"
        thread.join()
        assert not servers._servers
        assert run(servers, spheres()).status == "ok"


def test_no_more_processes_is_an_error_that_says_what_is_kept(spheres, monkeypatch):
    def refuse(*_, **__):
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr("harness.runner.servers.subprocess.Popen", refuse)
    with Servers() as servers, pytest.raises(InputError, match="every finished run is kept"):
        run(servers, spheres())


@pytest.mark.slow
def test_a_server_finds_the_modules_of_its_sweep_and_none_of_the_working_directory(spheres, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("random", "queue", "numpy", "harness"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('the wrong module')\n")
    with Servers() as servers:
        assert run(servers, spheres()).status == "ok"


@pytest.mark.slow
def test_limits_of_the_user_are_kept_and_no_fault(spheres, monkeypatch):
    """As after `ulimit -f 100; ulimit -v 4000000`: a run lowers its limits, and cannot raise them."""
    hard = {resource.RLIMIT_FSIZE: 100 * 1024, resource.RLIMIT_AS: 4_000_000 * 1024}
    wanted = rooms.subprocess.Popen

    def limited(*arguments, **options):
        def lower():
            for what, most in hard.items():
                resource.setrlimit(what, (most, most))

        return wanted(*arguments, preexec_fn=lower, **options)

    monkeypatch.setattr("harness.runner.servers.subprocess.Popen", limited)
    with Servers() as servers:
        assert run(servers, spheres()).status == "ok"
