"""One run in a process of its own, forked from this one: limits before, a watch meanwhile, and afterwards nothing left.

This process adopts what a run leaves behind, so that a grandchild in a session of its own is ended like any other.
"""

from __future__ import annotations

import gc
import os
import pickle
import sys
import traceback
from contextlib import suppress
from functools import partial
from multiprocessing.connection import Connection

from harness.child_process import Channel, Child, Ending, NoMessage
from harness.errors import InputError
from harness.measure.conditions import Conditions
from harness.process_limits import limit
from harness.runner.execute import execute
from harness.runner.scene_of_point import SceneSizeError
from harness.runner.task import Report, Task
from harness.scene.launch import PlacementError
from harness.scene.scene_files import SceneFiles

# What a run may write to its own output; a backend that prints without end must not fill the memory.
_OUTPUT_LIMIT = 16 * 2**20
_TAIL = 2000


def run_isolated(task: Task, files: SceneFiles, channel: Connection) -> Report | None:
    """Run a task in a forked process and say how it ended; None if the other side of the channel has gone meanwhile."""
    conditions = Conditions(pinned=task.pinned)
    output = os.memfd_create("output")
    try:
        with Child.fork(partial(_run, task, files, channel, conditions.core), output) as child:
            answer = child.receive(task.timeout, stop=channel)
            ending = child.end()
        printed = _tail(output)
    finally:
        os.close(output)
    if answer == "stopped":
        return None
    report = _report(answer, ending, printed, task.timeout, unread=child.unread)
    return report.with_circumstances(printed, conditions.metrics())


def _run(task: Task, files: SceneFiles, channel: Connection, core: int | None, answers: Channel) -> None:
    """The forked process: limits, then the run, then its report."""
    channel.close()  # not for a backend to write to
    if core is not None:
        with suppress(OSError):
            os.sched_setaffinity(0, {core})
    limit(memory=task.memory, output=_OUTPUT_LIMIT)
    report = _reported(task, files)
    with suppress(Exception):  # of what a backend has made of them
        sys.stdout.flush()
        sys.stderr.flush()
    answers.send(report)


def _reported(task: Task, files: SceneFiles) -> bytes:
    memory = Report("memory", f"needed more than {task.memory / 2**30:.3g} GiB")
    try:
        try:
            result = execute(
                task.point,
                files,
                memory=task.memory,
                traced=task.traced,
                recorded=task.recorded,
                on_demand=task.on_demand,
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


def _report(answer: bytes | NoMessage, ending: Ending, printed: str, timeout: float, *, unread: bool) -> Report:
    """The report of a run, or what it means that there is none."""
    if answer == "timeout":
        return Report("timeout", f"did not end within {timeout:g} s")
    if isinstance(answer, bytes):
        with suppress(Exception):  # whatever a backend wrote into the socket
            report = pickle.loads(answer)
            if isinstance(report, Report):
                return report
    if isinstance(answer, bytes) or (unread and not ending.code):
        return Report("crashed", "its report cannot be read")
    if "bad_alloc" in printed or "MemoryError" in printed:
        return Report("memory", "ran out of the memory it may use")
    return Report("memory" if ending.killed else "crashed", ending.instead_of("a result"))


def _tail(output: int) -> str:
    size = os.fstat(output).st_size
    return os.pread(output, _TAIL, max(0, size - _TAIL)).decode("utf-8", "replace")
