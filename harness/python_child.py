"""How a process of this package starts another: the same Python, which finds the same modules."""

from __future__ import annotations

import os
import sys

# `python -m` would look into the working directory first, where a file such as random.py may lie.
_RUN = (
    "import sys; sys.path[:] = sys.argv.pop(1).split('\\n'); import runpy; "
    "runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)"
)


def python_command(module: str, *arguments: str) -> list[str]:
    """The command line that runs a module with arguments, and with the `sys.path` of this process."""
    path = "\n".join(map(os.path.abspath, sys.path))
    return [sys.executable, "-c", _RUN, path, module, *arguments]
