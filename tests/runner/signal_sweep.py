"""Signals at random moments, at the sweeping process, at a run and at a warm server.

    python tests/runner/signal_sweep.py [HITS] [TARGET/SIGNAL ...]

No finished run may be lost or done twice, no process left; a sweep that is asked to end says what is kept and exits 130
or 143; one whose runs or servers are hit comes to its end by itself. Prints tries and failures of each.
"""

from __future__ import annotations

import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import psutil

from tests.runner.kill_sweep import Killed

SIGNALS = {
    "SIGKILL": [signal.SIGKILL],
    "SIGTERM": [signal.SIGTERM],
    "SIGINT": [signal.SIGINT],
    "SIGINT twice": [signal.SIGINT, signal.SIGINT],
    "SIGSTOP": [signal.SIGSTOP, signal.SIGCONT],
}
TARGETS = ("sweep", "run", "server")
# What becomes of a sweep that is hit itself.
ENDS = {"SIGKILL": -9, "SIGTERM": 143, "SIGINT": 130, "SIGINT twice": 130}
# How a run may end that is hit itself; whatever hits its server, it is done once more, and ends well.
STATUSES = {"SIGKILL": {"ok", "memory"}, "SIGTERM": {"ok", "crashed"}}
PAUSE = 0.1  # s that each run of one of the two backends takes at the least, so that it can be hit
BETWEEN = 2.0  # s from one hit to the next, at the most
IN_A_ROW = 3  # hits at servers between two runs that end: after one more the run is given up, by design


class Hit(Killed):
    """A folder with a sweep that is hit by signals."""

    def __post_init__(self) -> None:
        super().__post_init__()
        backend = self.folder / "leaves_backend.py"
        backend.write_text(backend.read_text().replace("        self.calls += 1\n", SLOWLY))

    def ended(self, name: str) -> None:
        """One sweep, hit while it starts, runs or ends."""
        sweep = self.start()
        assert sweep.stderr is not None
        wanted, before = self.order.choice((0, 0, 1, 2, 4)), len(self.said)
        while wanted and (line := sweep.stderr.readline()):
            self._hear(line)
            wanted -= ": ok" in line
        time.sleep(self.order.uniform(0.0, 3.0 if not self.said else 0.3))
        for number in SIGNALS[name]:
            sweep.send_signal(number)
            time.sleep(self.order.uniform(0.0, 0.05))
        rest = sweep.stderr.read()
        for line in rest.splitlines():
            self._hear(line)
        output, _ = sweep.communicate()
        assert self.all_gone(), f"processes are left: {self.processes()}"
        self.check()
        early = _while_python_starts(rest)
        assert "Traceback" not in rest or early or name == "SIGKILL", rest
        if sweep.returncode != 0:  # else it was hit too late
            started = (bool(rest) and not early) or len(self.said) > before  # else a signal ends it as any process
            assert sweep.returncode == ENDS[name] or not started, f"exit code {sweep.returncode}: {rest}"
            assert name == "SIGKILL" or "kept" in rest or "interrupted" in rest or not started, rest
        assert sweep.returncode != 0 or "runs done" in output

    def pelted(self, target: str, name: str, hits: int) -> int:
        """One sweep to its end, its runs or servers hit so often meanwhile; how often that was."""
        sweep = self.start()
        assert sweep.stderr is not None
        os.set_blocking(sweep.stderr.fileno(), False)
        done, row, text = 0, 0, ""
        while sweep.poll() is None:
            time.sleep(self.order.uniform(0.0, BETWEEN))
            new = _said(sweep.stderr.fileno())
            text, row = text + new, 0 if ": ok" in new else row
            found = list(self._targets(sweep.pid, target)) if done < hits else []
            if not found or (target == "server" and row == IN_A_ROW):
                continue
            row += 1
            process = self.order.choice(found)
            for number in SIGNALS[name]:
                with suppress(psutil.NoSuchProcess):
                    process.send_signal(number)
                time.sleep(self.order.uniform(0.0, 1.0) if number == signal.SIGSTOP else 0.0)
            done += 1
        text += _said(sweep.stderr.fileno())
        output, _ = sweep.communicate()
        assert "Traceback" not in text, text
        assert self.all_gone(), f"processes are left: {self.processes()}"
        for line in text.splitlines():
            self._hear(line)
        kept = self.check()
        assert kept == 2 * self.repeats, f"{kept} of {2 * self.repeats} runs: {text}{output}"
        return done

    def _targets(self, sweep: int, target: str) -> Iterator[psutil.Process]:
        with suppress(psutil.Error):
            for child in psutil.Process(sweep).children():
                if target == "sweep":
                    yield psutil.Process(sweep)
                elif "harness.runner.server" in child.cmdline():
                    yield from [child] if target == "server" else child.children()


def _while_python_starts(errors: str) -> bool:
    """Whether a signal came before the first line of the program that could answer it, as Python itself tells it."""
    begun = "init_import_site" in errors or "runpy" in errors
    return begun and "harness/__main__.py" not in errors and "harness/cli" not in errors


def _said(pipe: int) -> str:
    """What there is to read of a pipe that does not block."""
    text = b""
    with suppress(BlockingIOError):
        while part := os.read(pipe, 1 << 16):
            text += part
    return text.decode()


SLOWLY = f"""        self.calls += 1
        if self.calls == 1:
            time.sleep({PAUSE})
"""


def once(target: str, name: str, tries: int, seed: int = 259) -> int:
    """So many tries of one signal at one target; the failures."""
    failures, done, shown = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        ends = target == "sweep" and name in ENDS
        hit = Hit(Path(folder), repeats=5 * tries if ends else 2 * tries, seed=seed)
        hit.statuses = frozenset(STATUSES.get(name, {"ok"}) if target == "run" else {"ok"})
        while done < tries:
            try:
                if ends:
                    hit.ended(name)
                    done += 1
                else:
                    done += max(1, hit.pelted(target, name, tries - done))
                    hit.database.unlink()
                    hit.said.clear()
            except AssertionError as error:
                failures, done = failures + 1, done + 1
                print(f"{name} at the {target}, try {done}: {error}", flush=True)
                for process in hit.processes():
                    process.kill()
                if not ends:  # what one try leaves is not the next one's
                    hit.database.unlink(missing_ok=True)
                    hit.said.clear()
            if done < tries and done // 10 > shown // 10:  # so that something is known if this is broken off
                print(f"{name} at the {target}: {done} tries so far, {failures} failures", flush=True)
                shown = done
    print(f"{name} at the {target}: {done} tries, {failures} failures", flush=True)
    return failures


def main(hits: int, wanted: list[str]) -> None:
    """Every signal at every target."""
    began, failures, random_seed = time.monotonic(), 0, random.Random(259)
    for target in TARGETS:
        for name in SIGNALS:
            if not wanted or f"{target}/{name}" in wanted:
                failures += once(target, name, hits, random_seed.randrange(10**6))
    print(f"{failures} failures in {time.monotonic() - began:.0f} s")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100, sys.argv[2:])
