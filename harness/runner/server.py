"""A warm server: a process with everything a backend's runs need imported and compiled, which forks once a run.

`python -m harness.runner.server FD BACKEND` is the server; it speaks through the socket FD, which it inherits. Each run
happens in a process forked from it, with limits of its own, so that a backend that crashes, hangs, fills the memory or
prints costs its own run only. When the socket closes, the server ends its run and itself.
"""

from __future__ import annotations

import ctypes
import gc
import os
import resource
import signal
import sys
import tempfile
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from typing import NoReturn

from harness.backends import registry
from harness.errors import InputError
from harness.runner.execute import execute, warm_up
from harness.runner.setting import SceneSizeError
from harness.runner.task import Report, Task
from harness.scene.launch import PlacementError
from harness.scene.mesh import Mesh

# What a run may write to its own output; a backend that prints without end must not fill the disk.
_OUTPUT_LIMIT = 16 * 2**20
_TAIL = 2000
_PR_SET_PDEATHSIG = 1


def main() -> None:
    """Serve until the other side closes the socket."""
    channel: Connection = Connection(int(sys.argv[1]))
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the sweeping process answers Ctrl-C, by closing the socket
    _die_with_parent()
    if sys.argv[2] in registry.names():
        with suppress(InputError):  # a run will say it, in its report
            registry.create(sys.argv[2])
    warm_up()
    gc.collect()
    gc.freeze()  # so that the collector of a run does not look at, and copy, what the server holds
    meshes: dict[str, Mesh] = {}
    channel.send("ready")
    while True:
        try:
            received = channel.recv()
        except (EOFError, OSError):
            return
        if isinstance(received, Mesh):
            meshes[received.digest] = received
        else:
            mesh = None if received.mesh is None else meshes[received.mesh]
            report = _run(received, mesh, channel)
            if report is None:
                return
            channel.send(report)


def _run(task: Task, mesh: Mesh | None, channel: Connection) -> Report | None:
    """Run a task in a forked process and say how it ended; None if the other side has gone meanwhile."""
    receiver, sender = Pipe(duplex=False)
    with tempfile.TemporaryFile() as output:
        child = os.fork()
        if child == 0:
            _be_the_run(task, mesh, sender, output.fileno())
        sender.close()
        with receiver, _ending(child) as ended:
            ready = wait([receiver, channel, ended], timeout=task.timeout)
            report = _received(receiver) if receiver in ready else None
            if ready and report is None:
                wait([ended], timeout=1.0)  # it is about to end by itself; how it does is what we want to know
        status = _end(child)
        if ready == [channel]:
            return None
        printed = _tail(output.fileno())
    if report is None:
        report = _post_mortem(status, printed) if ready else Report("timeout", f"did not end within {task.timeout:g} s")
    return report.with_stderr(printed)


@contextmanager
def _ending(child: int) -> Iterator[int]:
    """A file descriptor that becomes readable when the process ends."""
    descriptor = os.pidfd_open(child)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def _received(receiver: Connection) -> Report | None:
    """The report of a run; None if it ended without one."""
    try:
        report: Report = receiver.recv()
    except (EOFError, OSError):
        return None
    return report


def _be_the_run(task: Task, mesh: Mesh | None, sender: Connection, output: int) -> NoReturn:
    """The forked process: limits, then the run, then its report."""
    os.setsid()  # a session of its own, so that it can be ended with all that it may start
    _die_with_parent()
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    os.dup2(output, 1)
    os.dup2(output, 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (_OUTPUT_LIMIT, _OUTPUT_LIMIT))
    resource.setrlimit(resource.RLIMIT_AS, (_virtual_memory() + task.memory,) * 2)
    try:
        result = execute(task.point, mesh, memory=task.memory, traced=task.traced)
        report = Report("ok", None, metrics=result.metrics, plan=result.plan, trace=result.trace)
    except MemoryError:
        report = Report("memory", f"needed more than {task.memory / 2**30:.3g} GiB")
    except (PlacementError, SceneSizeError, InputError) as error:
        report = Report("rejected", str(error))
    except BaseException as error:
        traceback.print_exc()
        sys.stderr.flush()
        report = Report("failed", f"{type(error).__name__}: {error}")
    sender.send(report)
    os._exit(0)


def _end(child: int) -> int:
    """Kill what is left of a run and of everything it started; the wait status of its first process."""
    for kill in (os.killpg, os.kill):  # the group exists once the child has made its session
        with suppress(ProcessLookupError):
            kill(child, signal.SIGKILL)
    return os.waitpid(child, 0)[1]


def _post_mortem(status: int, stderr: str) -> Report:
    """What the end of a process without a report means."""
    if "bad_alloc" in stderr or "MemoryError" in stderr:
        return Report("memory", "ran out of the memory it may use")
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        if number == signal.SIGKILL:
            return Report("memory", "killed by the system (signal 9), most likely because memory ran out")
        return Report("crashed", f"ended by signal {number} ({signal.Signals(number).name})")
    return Report("crashed", f"ended without a result, exit code {os.WEXITSTATUS(status)}")


def _tail(output: int) -> str:
    size = os.fstat(output).st_size
    return os.pread(output, _TAIL, max(0, size - _TAIL)).decode("utf-8", "replace")


def _die_with_parent() -> None:
    """Ask the kernel to end this process when its parent ends, however that happens (Linux only)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _virtual_memory() -> int:
    """B of address space this process uses already."""
    try:
        with open("/proc/self/statm", encoding="ascii") as statm:
            return int(statm.read().split()[0]) * resource.getpagesize()
    except OSError:
        return 0


if __name__ == "__main__":
    main()
