"""One run in a process of its own, forked from this one: limits before, a watch meanwhile, and afterwards nothing left.

The process that forks takes in whatever a run leaves behind (a "subreaper"), so that a grandchild in a session of its
own is ended like any other. Linux only, as far as processes are concerned.
"""

from __future__ import annotations

import ctypes
import gc
import os
import pickle
import resource
import signal
import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Literal, NoReturn

import psutil

from harness.errors import InputError
from harness.measure.conditions import Conditions
from harness.runner.execute import execute
from harness.runner.setting import SceneSizeError
from harness.runner.task import Report, Task
from harness.scene.launch import PlacementError
from harness.scene.mesh import Mesh

# What a run may write to its own output; a backend that prints without end must not fill the memory.
_OUTPUT_LIMIT = 16 * 2**20
_REPORT_LIMIT = 2**31
_TAIL = 2000
_CHUNK = 2**20
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36


def run_isolated(task: Task, mesh: Mesh | None, channel: Connection) -> Report | None:
    """Run a task in a forked process and say how it ended; None if the other side of the channel has gone meanwhile."""
    conditions = Conditions(pinned=task.pinned)
    receiver, sender = os.pipe()
    output = os.memfd_create("output")
    try:
        child = os.fork()
        if child == 0:
            os.close(receiver)
            _be_the_run(task, mesh, sender, output, channel, conditions.core)
        os.close(sender)
        watched = _watch(child, receiver, channel, task.timeout)
        status = _end(child)
        printed = _tail(output)
    finally:
        os.close(receiver)
        os.close(output)
    if watched.why == "alone":
        return None
    report = _report(watched, status, printed, task.timeout)
    return report.with_circumstances(printed, conditions.metrics())


def adopt_orphans() -> None:
    """Let what the runs of this process leave behind become its children, so that `run_isolated` finds it."""
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)


def die_with_parent(wanted: bool = True) -> None:
    """Ask the kernel to end this process when the thread that started it ends, however that happens; or no longer."""
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL if wanted else 0)


@dataclass(frozen=True)
class _Watched:
    """What a run sent until it ended, its time was over, or nobody was left to tell."""

    why: Literal["ended", "timeout", "alone"]
    sent: bytes


def _watch(child: int, receiver: int, channel: Connection, timeout: float) -> _Watched:
    os.set_blocking(receiver, False)
    deadline = time.monotonic() + timeout
    sent = bytearray()
    with _ending(child) as ended:
        waiting: list[int | Connection] = [receiver, channel, ended]
        while True:
            ready = wait(waiting, timeout=max(0.0, deadline - time.monotonic()))
            if receiver in ready and not _read(receiver, sent):
                waiting.remove(receiver)  # it closed its end; how it ends is still to be seen
            if channel in ready:
                return _Watched("alone", b"")
            if ended in ready:
                while _read(receiver, sent):
                    pass
                return _Watched("ended", bytes(sent))
            if not ready:
                return _Watched("timeout", b"")


def _read(receiver: int, sent: bytearray) -> bool:
    """Take what there is; False where there is nothing (more), or more than any report needs."""
    try:
        chunk = os.read(receiver, _CHUNK)
    except BlockingIOError:
        return False
    sent += chunk
    return bool(chunk) and len(sent) <= _REPORT_LIMIT


@contextmanager
def _ending(child: int) -> Iterator[int]:
    """A file descriptor that becomes readable when the process ends."""
    descriptor = os.pidfd_open(child)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def _be_the_run(
    task: Task, mesh: Mesh | None, sender: int, output: int, channel: Connection, core: int | None
) -> NoReturn:
    """The forked process: limits, then the run, then its report. It never returns, whatever happens."""
    try:
        os.setsid()  # a session of its own, so that it can be ended with all that it may start
        die_with_parent()
        channel.close()  # not for a backend to write to
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os.close(output)
        if core is not None:
            with suppress(OSError):
                os.sched_setaffinity(0, {core})
        _lower(resource.RLIMIT_CORE, 0)
        _lower(resource.RLIMIT_FSIZE, _OUTPUT_LIMIT)
        _lower(resource.RLIMIT_AS, _virtual_memory() + task.memory)
        _send(sender, _reported(task, mesh))
    except BaseException:
        traceback.print_exc()
    finally:
        with suppress(BaseException):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(0)


def _lower(what: int, most: int) -> None:
    """Lower a limit of this process for good; one that is lower already cannot be raised, and stays."""
    _, hard = resource.getrlimit(what)
    most = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(what, (most, most))


def _reported(task: Task, mesh: Mesh | None) -> bytes:
    memory = Report("memory", f"needed more than {task.memory / 2**30:.3g} GiB")
    try:
        try:
            result = execute(
                task.point, mesh, memory=task.memory, traced=task.traced, recorded=task.recorded, asked=task.asked
            )
            report = Report(
                "ok",
                None,
                result.metrics,
                result.plan,
                result.trace,
                {"flights": result.flights},
                recording=result.recording,
            )
        except MemoryError:
            report = memory
        except (PlacementError, SceneSizeError, InputError) as error:
            report = Report("rejected", str(error))
        except BaseException as error:
            traceback.print_exc()
            report = Report("failed", f"{type(error).__name__}: {error}")
        return pickle.dumps(report)
    except MemoryError:  # the report itself was too much
        gc.collect()
        return pickle.dumps(memory)


def _send(sender: int, content: bytes) -> None:
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(sender, rest) :]


def _end(child: int) -> int:
    """Kill what is left of a run and of everything it started; the wait status of its first process."""
    for kill in (os.killpg, os.kill):  # the group exists once the child has made its session
        with suppress(ProcessLookupError):
            kill(child, signal.SIGKILL)
    status = os.waitpid(child, 0)[1]
    while True:  # what it left behind has become ours, and what that leaves behind in turn
        try:
            ended, _ = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return status
        if not ended:
            for left in psutil.Process().children(recursive=True):
                with suppress(psutil.NoSuchProcess):
                    left.kill()
            os.waitpid(-1, 0)


def _report(watched: _Watched, status: int, printed: str, timeout: float) -> Report:
    if watched.why == "timeout":
        return Report("timeout", f"did not end within {timeout:g} s")
    if not watched.sent:
        return _post_mortem(status, printed)
    try:
        report = pickle.loads(watched.sent)
    except Exception:  # whatever a backend wrote into the pipe
        report = None
    if isinstance(report, Report):
        return report
    return _post_mortem(status, printed) if status else Report("crashed", "its report was garbage")


def _post_mortem(status: int, stderr: str) -> Report:
    """What the end of a process without a report means."""
    if "bad_alloc" in stderr or "MemoryError" in stderr:
        return Report("memory", "ran out of the memory it may use")
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        if number == signal.SIGKILL:
            return Report("memory", "killed by the system (signal 9), most likely because memory ran out")
        return Report("crashed", f"ended by signal {number} ({signal_name(number)})")
    return Report("crashed", f"ended without a result, exit code {os.WEXITSTATUS(status)}")


def signal_name(number: int) -> str:
    """SIGSEGV for 11; real-time signals have no name."""
    return signal.Signals(number).name if number in set(signal.Signals) else "a real-time signal"


def _tail(output: int) -> str:
    size = os.fstat(output).st_size
    return os.pread(output, _TAIL, max(0, size - _TAIL)).decode("utf-8", "replace")


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value)


def _virtual_memory() -> int:
    """B of address space this process uses already."""
    try:
        with open("/proc/self/statm", encoding="ascii") as statm:
            return int(statm.read().split()[0]) * resource.getpagesize()
    except OSError:
        return 0
