"""Backends that do what they must not, on import or in a run: every command says so, and goes on with the others.

    python tests/runner/hostile_plugins.py [WAY ...]

Each way to go wrong is installed as a package of its own and met by the real commands; prints what came of each, and
how many tries went wrong: a command taken down, a trace of the program's own code, results that are no JSON, a process
left behind.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import textwrap
import time
import uuid
from contextlib import suppress
from pathlib import Path

import psutil

IMPORTS = "import ctypes, os, signal, sys, threading, time\nimport numpy as np\n"
BACKEND = """
class Plugin:
    name = "odd"
    shapes = ("sphere", "hull", "mesh")

    def tolerance(self, shape):
        return 1e-9

    def load(self, scene):
        pass

    def pairs(self, positions, quaternions):
{body}
        return np.empty((0, 2), int)
"""
HANG = "signal.pthread_sigmask(signal.SIG_BLOCK, range(1, 65))\ntime.sleep(1000)"
FLOOD = "os.write(1, b'y' * 40_000_000)\nprint('x' * 40_000_000)"
LEAVE = "if os.fork() == 0:\n    os.setsid()\n    time.sleep(1000)"
SPEAK = "threading.Thread(target=lambda: [print('z' * 1000, flush=True) for _ in iter(int, 1)], daemon=True).start()"
# What is done on import.
HEADS = {
    "exits": "os._exit(3)",
    "exits without a word": "os._exit(0)",
    "raises SystemExit": "raise SystemExit",
    "raises KeyboardInterrupt": "raise KeyboardInterrupt",
    "hangs with signals blocked": HANG,
    "prints without end": FLOOD,
    "closes descriptors": "os.closerange(0, 1000)",
    "goes elsewhere": "os.chdir('/')",
    "is broken": "1 / 0",
    "lacks a library": "import there_is_no_such_library",
    "is no Python": "this is no Python",
    "crashes": "ctypes.string_at(0)",
    "leaves a process": LEAVE,
    "leaves a process and exits": LEAVE + "\nos._exit(3)",
    "fills the memory": "block = [bytearray(1 << 28) for _ in range(1000)]",
    "speaks in a thread": SPEAK,
    "is slow": "time.sleep(60)",
}
# What is done when it is asked for pairs.
BODIES = {
    "exits in a run": "os._exit(3)",
    "raises SystemExit in a run": "raise SystemExit",
    "hangs with signals blocked in a run": HANG,
    "prints without end in a run": FLOOD,
    "closes descriptors in a run": "os.closerange(0, 1000)",
    "goes elsewhere in a run": "os.chdir('/')",
    "answers nothing": "return None",
    "answers text": "return 'none'",
    "answers bodies that there are not": "return np.array([[0, 99]])",
    "answers what is no number": "return np.array([[0.0, np.nan]])",
    "answers one body twice": "return np.array([[1, 1]])",
    "leaves a process in a run": LEAVE,
}
ENTRIES = {
    "points to nothing": "odd = odd_backend:Nothing",
    "points to no module": "odd = there_is_no_such_module:Plugin",
    "points to no name": "odd = not a name:::",
    "points to a number": "odd = odd_backend:time.timezone",
}
EXPERIMENT = """
title: Odd
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.5}
zip: [{backend: [fcl, odd], algorithm: [grid, native]}]
measure: {repeats: 2, timeout: TIMEOUT, memory: 1GiB}
"""
COMMANDS = {
    "list": ["list", "--json"],
    "validate": ["validate", "odd.yaml"],
    "plan": ["plan", "odd.yaml", "--json"],
    "trace": ["trace", "odd.yaml", "--json", "--set", "backend=odd", "--set", "algorithm=native"],
    "compare": ["compare", "odd.yaml", "--backends", "fcl,odd", "--json"],
    "sweep": ["sweep", "odd.yaml", "--db", "odd.db"],
}
LONGEST = 400.0  # s for a command, on a machine with other things to do
MARK = "HARNESS_PLUGIN_TEST"


def install(folder: Path, way: str) -> None:
    """A package with a backend that goes wrong in this way, and an experiment that names it."""
    head, body = HEADS.get(way, ""), BODIES.get(way, "pass")
    metadata = folder / "odd-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: odd\nVersion: 1.0\n")
    entry = ENTRIES.get(way, "odd = odd_backend:Plugin")
    (metadata / "entry_points.txt").write_text(f"[harness.backends]\n{entry}\n")
    source = f"{IMPORTS}{head}\n{BACKEND.format(body=textwrap.indent(body, 8 * ' '))}"
    (folder / "odd_backend.py").write_text(source)
    (folder / "odd.yaml").write_text(EXPERIMENT.replace("TIMEOUT", "100" if way == "is slow" else "5"))


def run(folder: Path, *words: str) -> tuple[int, str, str]:
    """A command in a folder, with its packages; what is left of it is ended, and said in its errors."""
    mark = uuid.uuid4().hex
    environment = os.environ | {"PYTHONPATH": f"{folder}:{os.environ.get('PYTHONPATH', '')}", MARK: mark}
    command = subprocess.Popen(
        [sys.executable, "-m", "harness", *words],
        cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        output, errors = command.communicate(timeout=LONGEST)
    except subprocess.TimeoutExpired:
        os.killpg(command.pid, 9)
        output, errors = command.communicate()
        errors += f"\nTraceback: did not end within {LONGEST:g} s"
    if left := left_behind(mark):
        errors += f"\nTraceback: left {left}"
        for process in left:
            process.kill()
    return command.returncode, output, errors


def left_behind(mark: str, within: float = 10.0) -> list[psutil.Process]:
    """The processes with this mark that do not end by themselves soon."""
    deadline = time.monotonic() + within
    while True:
        found = []
        for process in psutil.process_iter():
            with suppress(psutil.Error):
                if process.environ().get(MARK) == mark and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(process)
        if not found or time.monotonic() > deadline:
            return found
        time.sleep(0.1)


def wrong(name: str, code: int, output: str, errors: str) -> str | None:
    """What is not right about the end of a command."""
    if "Traceback" in errors:
        return errors[-400:]
    if code not in (0, 1, 2):
        return f"exit code {code}"
    if len(errors) > 20_000:
        return f"{len(errors)} letters of errors"
    if name in ("list", "plan", "trace", "compare") and output:
        try:
            json.loads(output)
        except ValueError:
            return f"no JSON: {output[:200]!r}"
    if not output and not errors:
        return "nothing was said"
    if name == "sweep" and "4 runs done" not in output:
        return f"not all runs were done: {output[-300:]!r} {errors[-300:]!r}"
    if name == "list" and '"fcl"' not in output:
        return "the others were not listed"
    return None


def main(ways: list[str]) -> None:
    """Every way, met by every command."""
    tries, failures = 0, 0
    for way in ways or [*HEADS, *BODIES, *ENTRIES]:
        with tempfile.TemporaryDirectory() as folder:
            install(Path(folder), way)
            said = []
            for name, words in COMMANDS.items():
                code, output, errors = run(Path(folder), *words)
                tries += 1
                complaint = wrong(name, code, output, errors)
                failures += complaint is not None
                said.append(f"{name} {code}" if complaint is None else f"{name} {code} WRONG: {complaint}")
            print(f"{way}: {', '.join(said)}", flush=True)
    print(f"{tries} tries, {failures} failures")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
