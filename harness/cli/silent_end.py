"""A signal that comes while nothing has begun, or when all is done: the process ends, and has nothing to say.

Hardly anything is imported here. Until this is called Ctrl-C shows a trace, as in any Python program.
"""

from __future__ import annotations

import os
import signal

SIGNALS = (signal.SIGINT, signal.SIGTERM)


def end_without_a_word() -> None:
    """Let a signal that comes while nothing has begun end the process, with the exit code of an interruption."""
    for number in SIGNALS:
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, exit_at_once)


def ignore_signals() -> None:
    """Let signals change nothing any more, for the last moment of a process that is ending because of one."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def exit_at_once(number: int, frame: object) -> None:
    """End this process as a signal does that asks it to."""
    os._exit(128 + number)
