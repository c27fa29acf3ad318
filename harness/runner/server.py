"""A warm server: a process that has imported and compiled what the runs of its backend need, and forks for each run.

`python -m harness.runner.server FD BACKEND` is the server; it speaks through the socket FD, which it inherits. Each run
happens in a process forked from it (`harness.runner.isolation`), so that a backend that crashes, hangs, fills the
memory or prints costs its own run only. When the socket closes, as it does however the other side ends, the server ends
its run, all that the run has started, and itself.
"""

from __future__ import annotations

import gc
import os
import sys
from contextlib import suppress
from multiprocessing.connection import Connection

from harness.backends import registry
from harness.backends.statement import ask_plugins_here
from harness.process_limits import adopt_orphans, die_with_parent, memory_of_plugin_limited, out_of_memory
from harness.runner.isolation import run_isolated
from harness.runner.task import Report, Task
from harness.runner.warm_up import warm_up
from harness.scene.mesh import Mesh
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene_files import SceneFiles


def main() -> None:
    """Serve until the other side closes the socket."""
    channel: Connection = Connection(int(sys.argv[1]))
    parent = os.getppid()
    die_with_parent()  # until it can see the socket close: importing a backend may hang
    if os.getppid() != parent:
        return
    adopt_orphans()
    ask_plugins_here()
    with suppress(EOFError, ConnectionError):  # the other side has gone
        _prepare(channel, sys.argv[2])
        _serve(channel)


def _prepare(channel: Connection, backend: str) -> None:
    """Import the backend, telling the other side when it begins and when it is done."""
    channel.send("started")
    if backend in registry.names():
        # a run will say what goes wrong, in its report, and has a limit of its own
        with suppress(BaseException), memory_of_plugin_limited():
            registry.create(backend)
    channel.send("ready")
    die_with_parent(False)


def _serve(channel: Connection) -> None:
    held: dict[str, Mesh | RecordedPoses] = {}
    while True:
        received = channel.recv()
        if isinstance(received, Mesh | RecordedPoses):
            held[received.identity] = received
            continue
        try:
            _warm_up(received)
        except (MemoryError, ImportError, OSError) as error:
            if not out_of_memory(error):
                raise
            channel.send("warm")
            channel.send(Report("memory", "to import and compile what it calls took more memory than there is"))
            return  # what is imported in part only is of no use to the next run
        channel.send("warm")
        report = run_isolated(received, SceneFiles.of(tuple(held[identity] for identity in received.files)), channel)
        if report is None:
            return
        channel.send(report)


def _warm_up(task: Task) -> None:
    """Compile and import what the run calls, before it is forked and its time counts."""
    die_with_parent()  # meanwhile nobody sees the socket close
    if warm_up(task.point):
        gc.collect()
        gc.freeze()  # so that the collector of a run does not look at, and copy, what the server holds
    die_with_parent(False)


if __name__ == "__main__":
    main()
