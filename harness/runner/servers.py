"""The warm servers of a sweep, one a backend, started when first needed and ended with it."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Mapping
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType

from harness.child_process import Ending, end
from harness.experiment.experiment import Experiment, Point
from harness.measure.metrics import ON_DEMAND
from harness.runner.task import Report, Task
from harness.scene.mesh import Mesh

# One thread a run: threads of numerical libraries would make CPU time mean something else on every machine.
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


class Servers:
    """Runs tasks in isolated processes. A context: leaving it ends every process it started."""

    def __init__(self) -> None:
        self._servers: dict[str, _Server] = {}
        self._broken: dict[str, Report] = {}

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
        """End every process, from another thread than the one that waits for a run."""
        for server in list(self._servers.values()):
            server.hang_up()

    def run(self, task: Task, mesh: Mesh | None) -> Report:
        """Run a task once in a process of its own; it never raises for what the run does.

        Parameters
        ----------
        task : what to run
        mesh : that it names
        """
        backend = task.point.engine.backend
        if backend in self._broken:
            return self._broken[backend]
        if backend not in self._servers:
            server = _Server(backend)
            self._servers[backend] = server
            broken = server.start(task.timeout)
            if broken is not None:
                self._servers.pop(backend).close()
                self._broken[backend] = broken
                return broken
        report = self._servers[backend].run(task, mesh)
        if report is None:
            self._servers.pop(backend).close()
            return Report("crashed", f'the server of backend "{backend}" ended unexpectedly')
        return report


def task_of(
    experiment: Experiment,
    point: Point,
    meshes: Mapping[Path, Mesh],
    *,
    traced: bool = False,
    pinned: bool = False,
    recorded: bool = False,
    asked: frozenset[str] | None = None,
) -> tuple[Task, Mesh | None]:
    """A run of a point under the limits of its experiment, and the mesh that it needs.

    `asked` are the metrics to make that are made on demand alone; without, those that the experiment names.
    """
    mesh, limits = mesh_of(experiment, point, meshes), experiment.measure
    asked = asked_of(experiment) if asked is None else asked
    digest = mesh.digest if mesh else None
    return Task(point, digest, limits.timeout, limits.memory, traced, pinned, recorded, asked), mesh


def asked_of(experiment: Experiment) -> frozenset[str]:
    """The metrics that an experiment names and that are made on demand alone."""
    return experiment.metrics & ON_DEMAND


def mesh_of(experiment: Experiment, point: Point, meshes: Mapping[Path, Mesh]) -> Mesh | None:
    """The mesh that a point of an experiment names, if it names one."""
    return None if point.scene.mesh is None else meshes[experiment.mesh_paths[point.scene.mesh]]


class _Server:
    """This side of one server process."""

    def __init__(self, backend: str) -> None:
        self._backend = backend
        ours, theirs = socket.socketpair()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "harness.runner.server", str(theirs.fileno()), backend],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                env=os.environ | _ONE_THREAD,
                # what is sent to the sweep's whole group, as a terminal does, is for the sweep to answer
                start_new_session=True,
            )
        self._channel: Connection = Connection(ours.detach())
        self._sent: set[str] = set()
        self._ready = False

    def start(self, timeout: float) -> Report | None:
        """Wait until it is ready to run; a report where its backend keeps it from that.

        Parameters
        ----------
        timeout : s that importing the backend may take
        """
        importing = f'importing backend "{self._backend}"'
        try:
            self._channel.recv()  # started, which takes as long as it takes
            if not self._channel.poll(timeout):
                return Report("timeout", f"{importing} did not end within {timeout:g} s")
            self._channel.recv()
        except (EOFError, OSError):
            return Report("crashed", f"{importing} ended its process with {Ending(self._process.wait())}")
        self._ready = True
        return None

    def run(self, task: Task, mesh: Mesh | None) -> Report | None:
        """The report of a task; None if the server has died."""
        try:
            if mesh is not None and mesh.digest not in self._sent:
                self._channel.send(mesh)
                self._sent.add(mesh.digest)
            self._channel.send(task)
            report: Report = self._channel.recv()
        except (EOFError, OSError):
            return None
        return report

    def hang_up(self) -> None:
        """Let the server see that nobody listens any more; it ends its run and itself."""
        with socket.socket(fileno=os.dup(self._channel.fileno())) as copy:
            copy.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """End the server and the run that it may have in flight."""
        self._channel.close()
        try:
            self._process.wait(timeout=5 if self._ready else 0)  # before it is ready it has no run to end, and may hang
        except subprocess.TimeoutExpired:
            end(self._process.pid)
            self._process.wait()
