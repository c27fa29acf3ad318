"""A sweep that is killed at any moment loses at most the run in flight, and the next goes on from there."""

from __future__ import annotations

import random
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.store import tables
from harness.store.database import Database

# Adds runs until it is killed and says each that is kept; or dies by itself in the middle of the last, before the
# statement of that number.
WRITER = """
import os, sys
from harness.store.database import Database
from harness.store.records import PointRow
path, statement = sys.argv[1], int(sys.argv[2])
database = Database.open(path)
sweep = database.begin_sweep("harness sweep", None, "0.1.0", {}, {})
database.list_experiment(sweep, "e", "E", None, "", {}, [PointRow("p", {"count": 5})])
repeat = len(database.done(["p"])["p"])
left = statement
def die(_):
    global left
    left -= 1
    if left == 0:
        os._exit(9)
while True:
    if statement and repeat == 3:
        database._connection.set_trace_callback(die)
    metrics = {f"metric_{number}": (float(repeat), "s") for number in range(5)}
    database.add_run(sweep, "p", repeat, "ok", None, "noise " * 200, metrics, True)
    print(repeat, flush=True)
    repeat += 1
    if statement and repeat == 4:
        os._exit(0)
"""


def start(path: Path, statement: int = 0) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", WRITER, str(path), str(statement)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def whole_runs(path: Path) -> int:
    """Runs in the file, after a check that it is undamaged and that each of them is whole."""
    records = tables.run_records(path)
    raw = sqlite3.connect(path)
    assert raw.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    assert raw.execute("PRAGMA foreign_key_check").fetchall() == []
    raw.close()
    assert [record.repeat for record in records] == list(range(len(records)))
    assert all(len(record.metrics) == 5 for record in records)
    return len(records)


@pytest.mark.slow
def test_a_kill_at_a_random_moment_loses_at_most_the_run_in_flight(path: Path) -> None:
    order = random.Random(259)
    kept = 0
    for _ in range(6):
        writer = start(path)
        assert writer.stdout is not None
        said = [int(writer.stdout.readline())]
        assert said == [kept]  # it goes on where the one before was killed
        time.sleep(order.uniform(0.0, 0.03))
        writer.send_signal(signal.SIGKILL)
        said += [int(line) for line in writer.stdout.read().split("\n") if line]
        writer.wait()
        found = whole_runs(path)
        assert said[-1] + 1 <= found <= said[-1] + 2
        kept = found


@pytest.mark.slow
@pytest.mark.parametrize("statement", range(1, 10))
def test_a_death_between_any_two_statements_of_a_run_leaves_the_runs_before(path: Path, statement: int) -> None:
    writer = start(path, statement)
    writer.communicate()
    assert writer.returncode == 9
    assert whole_runs(path) == 3
    with Database.open(path) as database:
        assert list(database.done(["p"])["p"]) == [0, 1, 2]


def test_a_reader_sees_finished_runs_while_a_sweep_writes(path: Path) -> None:
    writer = start(path)
    assert writer.stdout is not None
    try:
        for _ in range(5):
            said = int(writer.stdout.readline())
            assert len(tables.runs(path)) >= said + 1
    finally:
        writer.kill()
        writer.communicate()
