"""`python -m harness`, and the command `harness`."""

from __future__ import annotations

import sys

from harness.cli.silent_end import end_without_a_word, ignore_signals


def run() -> int:
    """Run the command line of this process; Ctrl-C is heeded from the first moment, when imports take longest."""
    end_without_a_word()
    from harness.cli.main import main

    code = main()
    if code > 128:  # else the interpreter, as it ends, would let a second signal change the exit code
        ignore_signals()
    return code


if __name__ == "__main__":
    sys.exit(run())
