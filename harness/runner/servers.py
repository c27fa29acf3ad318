"""The warm servers of a sweep, one a backend, started when first needed and ended with it.

A server that dies, or is silent for longer than its run may take, is ended with all that it has started, and its run is
done once more by a new one: whatever befell the server, it was most likely not this run's doing. One that was killed
from outside, as by a system that runs out of memory, says nothing of the run at all, which is tried more often.
"""

from __future__ import annotations

import os
import signal
import socket
import struct
import subprocess
import uuid
from contextlib import suppress
from multiprocessing.connection import Connection
from time import monotonic
from types import TracebackType
from typing import Any

import psutil

from harness.child_process import LONGEST_WAIT, Ending
from harness.errors import InputError
from harness.experiment.experiment import Experiment, Point
from harness.measure.metrics import ON_DEMAND
from harness.process_limits import interrupts_blocked
from harness.python_child import start_module
from harness.runner.task import Report, Task
from harness.scene.scene_files import Opened, SceneFiles

# One thread a run: threads of numerical libraries would make CPU time mean something else on every machine.
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)

# s that a server may take, on a machine with other things to do: to start, to import and compile what a run calls,
# beyond the time of a run to end it, and within a message. Longer, and it has been stopped, or hangs.
_START, _WARM_UP, _BEYOND, _MESSAGE = 300.0, 900.0, 60.0, 60
_IMPORT = 60.0  # s that importing a backend may take, where its runs may take less: that is no part of any of them
_LAST = 10.0  # s for the end of what is killed
_TRIES = 2
_TRIES_IF_KILLED = 4
# What ends a process from outside: the system that runs out of memory, or a watch over the memory that asks first.
_FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM)
# In the environment of a server, and so of all that it starts: by it that is found, wherever it has gone to.
_MARK = "HARNESS_SERVER"


class Servers:
    """Runs tasks in isolated processes. A context: leaving it ends every process it started."""

    def __init__(self) -> None:
        self._servers: dict[str, _Server] = {}
        self._broken: dict[str, Report] = {}
        self._interruptions = 0

    def __enter__(self) -> Servers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End every process."""
        for server in self._servers.values():
            server.close()
        self._servers.clear()

    def interrupt(self) -> None:
        """End every process, from another thread than the one that waits for a run; its run is not tried again."""
        self._interruptions += 1
        for server in list(self._servers.values()):
            server.hang_up()

    def run(self, task: Task, files: SceneFiles) -> Report:
        """Run a task once in a process of its own; it never raises for what the run does.

        Parameters
        ----------
        task : what to run
        files : that its scene names
        """
        backend = task.point.engine.backend
        interruptions = self._interruptions
        ending: Ending | None = None
        for tried in range(1, _TRIES_IF_KILLED + 1):
            if backend in self._broken:
                return self._broken[backend]
            report, ending = self._try(backend, task, files, tried)
            if report is not None:
                return report
            if self._interruptions > interruptions or _enough(tried, ending):
                break
        how = ending.instead_of("a report") if ending is not None and ending.code else "gave no report"
        return Report("crashed", f'the server of backend "{backend}" {how}')

    def _try(self, backend: str, task: Task, files: SceneFiles, tried: int) -> tuple[Report | None, Ending | None]:
        """The report of a task; without one, how the server ended, if by itself, that died or was silent over it."""
        if backend in self._servers and self._servers[backend].dead:  # this run has nothing to do with that
            self._servers.pop(backend).close()
        if backend not in self._servers:
            server = _Server(backend)
            self._servers[backend] = server
            broken = server.start(task.timeout)
            if broken is not None:
                self._servers.pop(backend).close()
                if broken.status == "crashed" and not _enough(tried, server.ending):
                    return None, server.ending
                if not _killed(server.ending):  # that says nothing of the next import
                    self._broken[backend] = broken
                return broken, server.ending
        server = self._servers[backend]
        report = server.run(task, files)
        if report is None:
            self._servers.pop(backend).close()
        return report, server.ending


def _enough(tries: int, ending: Ending | None) -> bool:
    """Whether a run is given up after so many tries, of which the last ended its server so."""
    return tries >= (_TRIES_IF_KILLED if _killed(ending) else _TRIES)


def _killed(ending: Ending | None) -> bool:
    """Whether a process was ended from outside."""
    return ending is not None and ending.signal in _FROM_OUTSIDE


def task_of(
    experiment: Experiment,
    point: Point,
    meshes: Opened,
    *,
    traced: bool = False,
    pinned: bool = False,
    recorded: bool = False,
    on_demand: frozenset[str] | None = None,
) -> tuple[Task, SceneFiles]:
    """A run of a point under the limits of its experiment, and the files that it needs.

    `on_demand` are the metrics to measure that are measured on demand alone; without, those the experiment names.
    """
    files, limits = files_of(experiment, point, meshes), experiment.measure
    pinned = pinned and point.engine.threads == 1
    on_demand = on_demand_of(experiment) if on_demand is None else on_demand
    task = Task(point, files.identities, limits.timeout, limits.memory, traced, pinned, recorded, on_demand)
    return task, files


def on_demand_of(experiment: Experiment) -> frozenset[str]:
    """The metrics that an experiment names and that are measured on demand alone."""
    return experiment.metrics & ON_DEMAND


def files_of(experiment: Experiment, point: Point, opened: Opened) -> SceneFiles:
    """The files that a point of an experiment names."""
    paths = [experiment.mesh_paths[name] for name in point.scene.mesh_names]
    if point.motion.poses is not None:
        paths.append(experiment.poses_paths[point.motion.poses])
    return SceneFiles.of(tuple(opened[path] for path in paths))


class _Server:
    """This side of one server process."""

    def __init__(self, backend: str) -> None:
        self._backend = backend
        self._mark = uuid.uuid4().hex
        ours, theirs = socket.socketpair()
        for option in (socket.SO_RCVTIMEO, socket.SO_SNDTIMEO):
            ours.setsockopt(socket.SOL_SOCKET, option, struct.pack("ll", _MESSAGE, 0))
        with theirs:
            try:
                with interrupts_blocked():  # the sweep answers Ctrl-C, also while the server starts
                    environment = os.environ | _ONE_THREAD | {_MARK: self._mark}
                    self._process = start_module("harness.runner.server", theirs, [backend], environment)
            except OSError as error:
                ours.close()
                why = f"no process can be started: {error.strerror}"
                raise InputError(f"{why}; every finished run is kept, and the same command does the rest") from error
        self._channel: Connection = Connection(ours.detach())
        self._sent: set[str] = set()
        self._ready = False
        self._killed_here = False
        self.ending: Ending | None = None  # if that was not by `close`

    @property
    def dead(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def start(self, timeout: float) -> Report | None:
        """Wait until it is ready to run; a report where its backend keeps it from that.

        Parameters
        ----------
        timeout : s that importing the backend may take, if it is more than it may in any case
        """
        importing = f'importing backend "{self._backend}"'
        try:
            self._receive(_START)
            try:
                self._receive(max(timeout, _IMPORT))
            except TimeoutError:
                return Report("timeout", f"{importing} did not end within {max(timeout, _IMPORT):g} s")
        except (EOFError, OSError):
            self._end()
            how = "did not come to its end" if self.ending is None else f"ended its process with {self.ending}"
            return Report("crashed", f"{importing} {how}")
        self._ready = True
        return None

    def run(self, task: Task, files: SceneFiles) -> Report | None:
        """The report of a task; None if the server has died, or is silent."""
        try:
            for part in files.parts:
                if part.identity not in self._sent:
                    self._channel.send(part)
                    self._sent.add(part.identity)
            self._channel.send(task)
            self._receive(_WARM_UP)
            report: Report = self._receive(task.timeout + _BEYOND)
        except (EOFError, OSError):
            return None
        return report

    def hang_up(self) -> None:
        """Let the server see that nobody listens any more; it ends its run and itself."""
        with suppress(OSError), socket.socket(fileno=os.dup(self._channel.fileno())) as copy:
            copy.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """End the server and the run that it may have in flight."""
        self._channel.close()
        if self._ready:  # else it has no run to end, and may hang
            self._await_end(5.0)
        if self.ending != Ending(0):
            self._end()

    def _receive(self, within: float) -> Any:
        """The next message.

        Raises
        ------
        TimeoutError
            If none begins within so many seconds.
        EOFError, OSError
            If the server has died.
        """
        deadline = monotonic() + within
        while not self._channel.poll(max(0.0, min(deadline - monotonic(), LONGEST_WAIT))):
            if monotonic() >= deadline:
                raise TimeoutError
        return self._channel.recv()

    def _await_end(self, within: float) -> None:
        """Give the process so many seconds to end by itself."""
        if not self._killed_here:
            with suppress(subprocess.TimeoutExpired):
                self.ending = Ending(self._process.wait(within))

    def _end(self) -> None:
        """End the process and all that it has started."""
        self._await_end(1.0)
        self._killed_here = True
        self._process.kill()
        self._process.wait()
        deadline = monotonic() + _LAST
        while (left := _marked(self._mark)) and monotonic() < deadline:  # what it has started may start more
            for process in left:
                with suppress(psutil.Error):
                    process.kill()
            psutil.wait_procs(left, timeout=0.1)


def _marked(mark: str) -> list[psutil.Process]:
    """The processes, but for those that have ended, with a mark of ours in their environment."""
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            if process.environ().get(_MARK) == mark and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process)
    return found
