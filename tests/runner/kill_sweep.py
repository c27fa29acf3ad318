"""Kills a sweep at random moments, as often as is asked for, and checks each time that nothing finished was lost.

    python tests/runner/kill_sweep.py [KILLS]

Half of the kills hit the sweeping process alone, the others all of its processes at once, as a power cut does. The
backend of half of its runs leaves a child behind, in a session of its own: that must go, too.
"""

from __future__ import annotations

import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import uuid
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import psutil

EXPERIMENT = """
title: To be killed
scene: {{shape: sphere, count: 4, box: [5, 5, 5]}}
motion: {{duration: 0.5}}
zip: [{{backend: [fcl, leaves], algorithm: [grid, native]}}]
measure: {{repeats: {repeats}}}
"""
BACKEND = """
import os, time
import numpy as np

class Leaves:
    name = "leaves"
    shapes = ("sphere",)
    calls = 0

    def tolerance(self, shape):
        return 0.0

    def load(self, scene):
        pass

    def pairs(self, positions, quaternions):
        self.calls += 1
        if self.calls == 1 and os.fork() == 0:
            os.setsid()
            time.sleep(600)
            os._exit(0)
        return np.empty((0, 2), int)
"""
MARK = "HARNESS_KILL_TEST"


@dataclass
class Killed:
    """A folder with a sweep that is killed, and what it has said so far."""

    folder: Path
    repeats: int
    seed: int = 259
    said: set[str] = field(default_factory=set)
    mark: str = field(default_factory=lambda: uuid.uuid4().hex)
    statuses: frozenset[str] = frozenset({"ok"})

    def __post_init__(self) -> None:
        self.order = random.Random(self.seed)
        self.database = self.folder / "kill.db"
        (self.folder / "kill.yaml").write_text(EXPERIMENT.format(repeats=self.repeats))
        (self.folder / "leaves_backend.py").write_text(BACKEND)
        metadata = self.folder / "leaves-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: leaves\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text("[harness.backends]\nleaves = leaves_backend:Leaves\n")

    def start(self, *options: str) -> subprocess.Popen[str]:
        """The real command, in a group of its own."""
        path = os.pathsep.join(filter(None, [str(self.folder), os.environ.get("PYTHONPATH", "")]))
        return subprocess.Popen(
            [sys.executable, "-m", "harness", "sweep", "kill.yaml", "--db", "kill.db", "--verbose", *options],
            cwd=self.folder, env=os.environ | {MARK: self.mark, "PYTHONPATH": path}, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True, preexec_fn=heed_ctrl_c,
        )  # fmt: skip

    def kill_once(self) -> int:
        """Start, kill at a random moment, check; the runs that are kept."""
        sweep = self.start()
        assert sweep.stderr is not None
        wanted = self.order.choice((0, 1, 2, 4, 8))  # runs; none: it may die while it starts
        while wanted and (line := sweep.stderr.readline()):
            self._hear(line)
            wanted -= ": ok" in line
        time.sleep(self.order.uniform(0.0, 0.1 if self.said else 3.0))
        everything = self.order.random() < 0.5
        for process in self.processes() if everything else [psutil.Process(sweep.pid)]:
            with suppress(psutil.NoSuchProcess):
                process.kill()
        for line in sweep.stderr.read().splitlines():
            self._hear(line)
        sweep.communicate()
        kept = self.check()
        if not everything:  # a power cut ends all processes by itself
            assert self.all_gone(), "processes are left"
        else:
            for process in self.processes():
                process.kill()
        return kept

    def _hear(self, line: str) -> None:
        if ": ok" in line:
            self.said.add(line.split(":")[0])

    def finish(self) -> str:
        """Let it come to its end; what it said."""
        sweep = self.start()
        output, errors = sweep.communicate()
        assert sweep.returncode == 0, errors
        assert self.check() == 2 * self.repeats
        return output

    def check(self) -> int:
        """The database is sound and keeps every run that was said to be done, once."""
        if not self.database.exists():
            return 0
        connection = sqlite3.connect(self.database)
        try:
            assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
            assert connection.execute("PRAGMA foreign_key_check").fetchall() == []
            if not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                return 0
            what = "json_extract(parameters, '$.backend'), json_extract(parameters, '$.algorithm'), repeat, status"
            rows, controls = (
                connection.execute(
                    f"SELECT {what}, {reason} FROM {table} JOIN point ON point.id = {table}.point"
                ).fetchall()
                for table, reason in (("run", "reason"), ("control", "NULL"))
            )
            empty = (
                "SELECT count(*) FROM run WHERE status = 'ok' "
                "AND NOT EXISTS (SELECT * FROM metric WHERE metric.run = run.id)"
            )
            assert connection.execute(empty).fetchone() == (0,)
        finally:
            connection.close()
        kept = [
            f"kill (backend {backend}, algorithm {algorithm}, repeat {n}{told})"
            for found, told in ((rows, ""), (controls, ", control"))
            for backend, algorithm, n, *_ in found
        ]
        assert len(kept) == len(set(kept)), "a run was done twice"
        assert self.said <= set(kept), f"lost: {self.said - set(kept)}"
        odd = [row for row in rows + controls if row[3] not in self.statuses]
        assert odd == [], f"how these ended is not its own doing: {odd}"
        return len(rows)

    def processes(self) -> list[psutil.Process]:
        """Every process that this sweep, or anything it started, has started."""
        found = []
        for process in psutil.process_iter():
            with suppress(psutil.Error):
                if process.environ().get(MARK) == self.mark and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(process)
        return found

    def all_gone(self, within: float = 10.0) -> bool:
        """Whether no process is left, at the latest after some seconds."""
        deadline = time.monotonic() + within
        while self.processes():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.05)
        return True


def heed_ctrl_c() -> None:
    """What a shell starts in the background ignores Ctrl-C, and so would all that it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def main(kills: int) -> None:
    """Kill so often, then let it come to its end."""
    with tempfile.TemporaryDirectory() as folder:
        sweep = Killed(Path(folder), repeats=20 + 3 * kills)
        began = time.monotonic()
        for number in range(1, kills + 1):
            kept = sweep.kill_once()
            print(f"kill {number}: sound, {kept} of {2 * sweep.repeats} runs kept, no process left", flush=True)
        print(sweep.finish(), end="")
        print(f"{kills} kills in {time.monotonic() - began:.0f} s: nothing lost, nothing done twice")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
