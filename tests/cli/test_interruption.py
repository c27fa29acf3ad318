"""SIGTERM ends a command as Ctrl-C does, and a second signal ends it at once."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from harness.cli import validate
from harness.cli.interruption import Interrupted, heeding_signals
from harness.cli.main import main
from harness.cli.silent_end import SIGNALS

TWICE = """
import os, signal, sys, time
from harness.cli.interruption import heeding_signals
with heeding_signals():
    try:
        os.kill(os.getpid(), signal.{first})
        time.sleep(60)
    finally:
        os.kill(os.getpid(), signal.{second})
        time.sleep(60)
"""


@pytest.fixture(autouse=True)
def as_before():
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    assert {number: signal.getsignal(number) for number in SIGNALS} == before


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_command_that_is_asked_to_end_says_so_and_exits_with_the_signal_in_its_code(
    number, code, monkeypatch, capsys
):
    def run(arguments):
        os.kill(os.getpid(), number)
        time.sleep(60)

    monkeypatch.setattr(validate, "run", run)
    assert main(["validate", "x.yaml"]) == code
    assert capsys.readouterr().err == "interrupted\n"


def test_what_is_begun_is_ended_before_a_command_is():
    ended = []

    def work():
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        finally:
            ended.append("in order")

    with heeding_signals(), pytest.raises(Interrupted, match="SIGTERM"):
        work()
    assert ended == ["in order"]


@pytest.mark.parametrize(("first", "second", "code"), [("SIGINT", "SIGINT", 130), ("SIGINT", "SIGTERM", 143)])
def test_the_second_signal_does_not_wait_for_the_end_of_anything(first, second, code):
    done = subprocess.run(
        [sys.executable, "-c", TWICE.format(first=first, second=second)], capture_output=True, text=True, timeout=50
    )
    assert done.returncode == code
    assert done.stderr == "interrupted twice: ended at once; every finished run is kept\n"


def test_a_signal_that_is_ignored_stays_ignored():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with heeding_signals():
            os.kill(os.getpid(), signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_command_runs_in_any_thread():
    codes = []
    thread = threading.Thread(target=lambda: codes.append(main(["validate", "there-is-no-such-file.yaml"])))
    thread.start()
    thread.join()
    assert codes == [2]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("moment", ["while it is imported", "when it has ended"])
def test_a_signal_before_and_after_a_command_ends_it_without_a_word(number, code, moment):
    program = (
        "from harness.cli.interruption import heeding_signals\n"
        "from harness.cli.silent_end import end_without_a_word\n"
        + ("end_without_a_word()" if moment == "while it is imported" else "with heeding_signals(last=True): pass")
        + f"\nimport os, time; os.kill(os.getpid(), {int(number)}); time.sleep(60)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (code, "")


def test_hardly_anything_is_imported_before_signals_are_heeded():
    """A signal that comes meanwhile shows a trace."""
    program = (
        "import os, re, signal, sys; before = set(sys.modules); import harness.__main__; "
        "print(*sorted(set(sys.modules) - before))"
    )
    done = subprocess.run([sys.executable, "-S", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["__future__", "harness", "harness.__main__", "harness.cli", "harness.cli.silent_end"]
