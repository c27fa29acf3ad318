"""A sweep of many tiny runs with a backend that segfaults on every tenth: the rows say which, and how long it took.

python tests/runner/thousand_runs.py [RUNS]
"""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

EXPERIMENT = """
title: Tiny runs
scene: {{shape: sphere, count: 4, box: [5, 5, 5]}}
motion: {{duration: 0.5}}
engine: {{backend: faints, algorithm: native}}
measure: {{repeats: {runs}}}
"""
BACKEND = """
import ctypes
from pathlib import Path
import numpy as np

class Faints:
    name = "faints"
    shapes = ("sphere",)
    calls = number = 0

    def tolerance(self, shape):
        return 0.0

    def load(self, scene):
        if not Faints.number:  # a process may load it twice, and has one run
            count = Path(__file__).with_name("count")
            Faints.number = int(count.read_text()) + 1 if count.exists() else 1
            count.write_text(str(Faints.number))

    def pairs(self, positions, quaternions):
        self.calls += 1
        if self.number % 10 == 0 and self.calls == 3:
            ctypes.string_at(0)
        return np.empty((0, 2), int)
"""


def sweep(folder: Path, runs: int) -> tuple[float, Counter[tuple[str, str | None]]]:
    """Elapsed seconds of the real command, and how often runs ended how."""
    (folder / "tiny.yaml").write_text(EXPERIMENT.format(runs=runs))
    (folder / "faints_backend.py").write_text(BACKEND)
    metadata = folder / "faints-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: faints\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[harness.backends]\nfaints = faints_backend:Faints\n")
    path = os.pathsep.join(filter(None, [str(folder), os.environ.get("PYTHONPATH", "")]))
    command = [sys.executable, "-m", "harness", "sweep", "tiny.yaml", "--db", "tiny.db", "--quiet"]
    began = time.monotonic()
    ended = subprocess.run(command, cwd=folder, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True)
    took = time.monotonic() - began
    assert ended.returncode == 1, ended.stderr  # runs failed
    connection = sqlite3.connect(folder / "tiny.db")
    rows = Counter(connection.execute("SELECT status, reason FROM run"))
    connection.close()
    return took, rows


def main(runs: int) -> None:
    """Print what came of so many runs."""
    with tempfile.TemporaryDirectory() as folder:
        took, rows = sweep(Path(folder), runs)
    for (status, reason), count in rows.items():
        print(f"{count} {status}{f': {reason}' if reason else ''}")
    print(f"{runs} runs in {took:.1f} s, {1000 * took / runs:.0f} ms each with all around it")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
