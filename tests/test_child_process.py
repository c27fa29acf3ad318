"""A child process is awaited with a deadline, limited, silent, and ended with everything that it started."""

import os
import resource
import signal
import subprocess
import sys
import textwrap
import time
from contextlib import suppress
from multiprocessing import Pipe

import psutil
import pytest

from harness import process_limits
from harness.child_process import Child, Ending, guarded
from harness.process_limits import limit
from tests.conftest import slow_beyond

SOON = 20.0


def gone(process, within=SOON):
    """Whether a process has ended, or ends soon."""
    deadline = time.monotonic() + within
    while psutil.pid_exists(process) and psutil.Process(process).status() != psutil.STATUS_ZOMBIE:
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True


def echo(channel):
    while (content := channel.receive()) is not None:
        channel.send(content[::-1])


def sleep(channel):
    channel.send(b"ready")
    time.sleep(600)


@pytest.mark.parametrize("content", [b"", b"abc", bytes(range(256)) * 20_000])
def test_messages_of_any_size_go_both_ways(content):
    with Child.fork(echo) as child:
        for _ in range(2):
            assert child.ask(content, SOON) == content[::-1]
    assert gone(child.pid, 0)


def test_several_messages_are_received_one_by_one():
    with Child.fork(lambda channel: [channel.send(b"one"), channel.send(b"two")]) as child:
        assert [child.receive(SOON) for _ in range(3)] == [b"one", b"two", "ended"]
        assert (child.unread, child.end()) == (False, Ending(0))


def test_a_child_that_does_not_answer_is_given_up_at_the_deadline_and_ended():
    with Child.fork(sleep) as child:
        assert child.receive(SOON) == b"ready"
        assert child.receive(0.05) == "timeout"
        assert child.ask(bytes(10**7), 0.05) == "timeout"  # it does not even read
    assert gone(child.pid, 0)
    assert child.end() == Ending(-signal.SIGKILL)


def test_waiting_stops_when_the_connection_says_so():
    ours, theirs = Pipe()
    with Child.fork(sleep) as child:
        assert child.receive(SOON) == b"ready"
        theirs.send("stop")
        assert child.receive(SOON, stop=ours) == "stopped"


@pytest.mark.parametrize(
    ("way", "code", "words", "reason"),
    [
        (lambda: os._exit(3), 3, "exit code 3", "ended without a result, exit code 3"),
        (lambda: os.abort(), -6, "signal 6 (SIGABRT)", "ended by signal 6 (SIGABRT)"),
        (
            lambda: os.kill(os.getpid(), 9), -9, "signal 9 (SIGKILL)",
            "killed by the system (signal 9), most likely because memory ran out",
        ),
        (lambda: os.kill(os.getpid(), 40), -40, "signal 40 (a real-time signal)",
         "ended by signal 40 (a real-time signal)"),
    ],
)  # fmt: skip
def test_how_a_child_ended_is_told_in_words(way, code, words, reason):
    with Child.fork(lambda channel: way()) as child:
        assert child.receive(SOON) == "ended"
        ending = child.end()
    assert (ending.code, str(ending), ending.instead_of("a result")) == (code, words, reason)


@pytest.mark.parametrize("garbage", [b"x", b"garbage " * 9])
def test_what_is_no_message_is_told_from_nothing(garbage):
    with Child.fork(lambda channel: channel._socket.sendall(garbage)) as child:
        assert child.receive(SOON) == "ended"
        assert child.unread


def hidden_grandchild(channel):
    """In a session of its own, its parent gone."""
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            os.setsid()
            channel.send(str(os.getpid()).encode())
            time.sleep(600)
        os._exit(0)
    time.sleep(600)


def test_what_a_child_started_ends_with_it_wherever_it_hides():
    with Child.fork(hidden_grandchild) as child:
        grandchild = int(child.receive(SOON))
        assert psutil.pid_exists(grandchild)
    assert gone(grandchild)


def test_what_a_crashed_child_left_behind_ends_where_the_parent_adopts_orphans():
    script = """
        import os, sys, time
        from harness.child_process import Child
        from harness.process_limits import adopt_orphans

        def crash(channel):
            started = os.fork()
            if started == 0:
                os.setsid()
                time.sleep(600)
            channel.send(str(started).encode())
            os.abort()

        adopt_orphans()
        with Child.fork(crash) as child:
            print(int(child.receive(60)), child.receive(60), child.end())
        """
    ran = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, check=True)
    started, *rest = ran.stdout.split(maxsplit=1)
    assert rest == ["ended signal 6 (SIGABRT)\n"]
    assert gone(int(started), 0)


def test_a_child_ends_with_its_parent():
    script = """
        import sys, time
        from harness.child_process import Child

        child = Child.fork(lambda channel: [channel.send(b"ready"), time.sleep(600)])
        child.receive(60)
        print(child.pid, flush=True)
        time.sleep(600)
        """
    parent = subprocess.Popen([sys.executable, "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, text=True)
    child = int(parent.stdout.readline())
    assert psutil.pid_exists(child)
    parent.kill()
    parent.communicate()
    assert gone(child)


def test_what_a_child_prints_goes_nowhere_or_into_its_file(capfd):
    def speak(channel):
        print("from Python", flush=True)
        os.write(2, b"from below\n")
        raise ValueError("at the end")

    with Child.fork(speak) as child:
        assert child.receive(SOON) == "ended"
    output = os.memfd_create("output")
    with Child.fork(speak, output) as child:
        assert child.receive(SOON) == "ended"
    printed = os.pread(output, 10_000, 0).decode()
    os.close(output)
    assert printed.startswith("from Python\nfrom below\nTraceback")
    assert printed.endswith("ValueError: at the end\n")
    assert capfd.readouterr() == ("", "")


def test_what_waits_to_be_printed_is_printed_once(capfd):
    sys.stdout.write("once")
    with Child.fork(echo):
        pass
    assert capfd.readouterr().out == "once"


def beyond_memory(channel):
    limit(memory=2**28)
    try:
        bytearray(2**29)
    except MemoryError:
        channel.send(b"refused")


def beyond_processor_time(channel):
    for _ in range(2):  # it can be set again
        limit(cpu=0.0)
    while True:
        pass


def beyond_output(channel):
    limit(output=1000)
    output = os.memfd_create("output")
    assert os.write(output, bytes(2000)) == 1000
    try:
        os.write(output, b"more")
    except OSError:
        channel.send(b"refused")


@pytest.mark.parametrize("way", [beyond_memory, beyond_output])
def test_what_is_beyond_a_limit_is_refused(way):
    with Child.fork(way) as child:
        assert child.receive(SOON) == b"refused"


@pytest.mark.slow
def test_more_cpu_time_than_allowed_ends_the_child():
    with Child.fork(beyond_processor_time) as child:
        assert child.receive(SOON) == "ended"
        assert child.end().signal == signal.SIGXCPU


def test_a_limit_that_is_lower_already_is_not_raised():
    def lower_twice(channel):
        import resource

        limit(output=1000)
        limit(output=10**6)
        channel.send(str(resource.getrlimit(resource.RLIMIT_FSIZE)).encode())

    with Child.fork(lower_twice) as child:
        assert child.receive(SOON) == b"(1000, 1000)"


@pytest.mark.parametrize(
    "way", slow_beyond([lambda: os._exit(3), os.abort, lambda: os.kill(os.getpid(), 9), lambda: None], 2)
)
def test_what_a_guarded_child_left_behind_ends_with_it_whatever_its_end(way):
    def leave(channel):
        started = os.fork()
        if started == 0:
            os.setsid()
            time.sleep(600)
        channel.send(str(started).encode())
        channel.send(channel.receive())
        way()

    with Child.fork(leave) as plain, Child.fork(guarded(leave)) as child:
        for one in (plain, child):
            left = int(one.receive(SOON))
            assert one.ask(b"go", SOON) == b"go"
            assert one.receive(SOON) == "ended"
            assert gone(left, 0) == (one is child)
            with suppress(ProcessLookupError):
                os.kill(left, 9)
        assert child.end() == plain.end()


def test_what_strangers_may_take_is_limited_and_given_back(monkeypatch):
    monkeypatch.setattr(process_limits, "_half_of_machine", lambda: 2**30)

    def fill(channel):
        before = resource.getrlimit(resource.RLIMIT_AS)
        with suppress(MemoryError), process_limits.memory_of_plugin_limited():
            bytearray(2**31)
            channel.send(b"filled")
        channel.send(b"given back" if resource.getrlimit(resource.RLIMIT_AS) == before else b"kept")
        process_limits.limit_memory_of_plugin()
        with suppress(MemoryError):
            bytearray(2**31)
            channel.send(b"filled")
        channel.send(b"limited")

    with Child.fork(fill) as child:
        assert [child.receive(SOON), child.receive(SOON)] == [b"given back", b"limited"]
