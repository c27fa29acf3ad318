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

from harness.experiment.experiment import Experiment, Point
from harness.runner.task import Report, Task
from harness.scene.mesh import Mesh

# One thread a run: threads of numerical libraries would make CPU time mean something else on every machine.
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


class Servers:
    """Runs points in isolated processes. A context: leaving it ends every process it started."""

    def __init__(self) -> None:
        self._servers: dict[str, _Server] = {}

    def __enter__(self) -> Servers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for server in self._servers.values():
            server.close()
        self._servers.clear()

    def run(self, experiment: Experiment, point: Point, meshes: Mapping[Path, Mesh], *, traced: bool = False) -> Report:
        """Run a point once in a process of its own; it never raises for what the run does.

        Parameters
        ----------
        experiment : whose limits (`measure.timeout`, `measure.memory`) hold
        point : one of its points
        meshes : every mesh of the experiment, opened
        traced : keep every hit
        """
        mesh = mesh_of(experiment, point, meshes)
        task = Task(point, mesh.digest if mesh else None, experiment.measure.timeout, experiment.measure.memory, traced)
        backend = point.engine.backend
        if backend not in self._servers:
            self._servers[backend] = _Server(backend)
        report = self._servers[backend].run(task, mesh)
        if report is None:
            self._servers.pop(backend).close()
            return Report("crashed", f'the server of backend "{backend}" ended unexpectedly')
        return report


def mesh_of(experiment: Experiment, point: Point, meshes: Mapping[Path, Mesh]) -> Mesh | None:
    """The mesh that a point of an experiment names, if it names one."""
    return None if point.scene.mesh is None else meshes[experiment.mesh_paths[point.scene.mesh]]


class _Server:
    """This side of one server process."""

    def __init__(self, backend: str) -> None:
        ours, theirs = socket.socketpair()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "harness.runner.server", str(theirs.fileno()), backend],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                env=os.environ | _ONE_THREAD,
            )
        self._channel: Connection = Connection(ours.detach())
        self._sent: set[str] = set()
        self._ready = False

    def run(self, task: Task, mesh: Mesh | None) -> Report | None:
        """The report of a task; None if the server has died."""
        try:
            if not self._ready:
                self._ready = bool(self._channel.recv())
            if mesh is not None and mesh.digest not in self._sent:
                self._channel.send(mesh)
                self._sent.add(mesh.digest)
            self._channel.send(task)
            report: Report = self._channel.recv()
        except (EOFError, OSError):
            return None
        return report

    def close(self) -> None:
        """End the server and the run that it may have in flight."""
        self._channel.close()
        try:
            self._process.wait(timeout=5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
