"""How a process of this package starts another: the same Python, which finds the same modules."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Mapping, Sequence

# `python -m` would look into the working directory first, where a file such as random.py may lie.
_RUN = (
    "import sys; sys.path[:] = sys.argv.pop(1).split('\\n'); import runpy; "
    "runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)"
)


def start_module(
    module: str,
    channel: socket.socket,
    arguments: Sequence[str],
    environment: Mapping[str, str],
    *,
    folder: str | None = None,
    silent: bool = False,
) -> subprocess.Popen[bytes]:
    """Start a module in an interpreter and a session of its own: what is sent to this process's group is not for it.

    Its standard output goes nowhere, for that is for results alone.

    Parameters
    ----------
    module : its name
    channel : the child's end, whose descriptor is its first argument
    arguments : that follow
    environment : variables of the child
    folder : that it starts in; by default that of this process
    silent : whether its standard error goes nowhere either
    """
    return subprocess.Popen(
        python_command(module, str(channel.fileno()), *arguments),
        pass_fds=[channel.fileno()],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL if silent else None,
        cwd=folder,
        env=environment,
        start_new_session=True,
    )


def python_command(module: str, *arguments: str) -> list[str]:
    """The command line that runs a module with arguments, and with the `sys.path` of this process."""
    path = "\n".join(map(os.path.abspath, sys.path))
    return [sys.executable, "-c", _RUN, path, module, *arguments]
