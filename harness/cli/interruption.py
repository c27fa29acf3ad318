"""Ctrl-C and SIGTERM: the first lets a command end what it has begun, the second ends it at once.

Either way nothing is lost: runs end when the socket to their server closes, and the database keeps whole transactions.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn

from harness.cli.silent_end import SIGNALS, exit_at_once

_SHOW_CURSOR = "\x1b[?25h"


class Interrupted(KeyboardInterrupt):
    """A signal asks the command to end; `code` is what it is to exit with, as shells have it: 130 for Ctrl-C."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.code = 128 + number


@contextmanager
def heeding_signals(*, last: bool = False) -> Iterator[None]:
    """Let signals raise `Interrupted` meanwhile, but for those that are ignored, as a shell's in the background are.

    Parameters
    ----------
    last : whether the process ends after it: then a signal that comes still later ends it without a word, but with
        the exit code of an interruption
    """
    if threading.current_thread() is not threading.main_thread():  # no other thread may say what signals do
        yield
        return
    heeded = {number: before for number in SIGNALS if (before := signal.getsignal(number)) != signal.SIG_IGN}
    for number in heeded:
        heed(number)
    try:
        yield
    finally:
        for number, before in heeded.items():
            signal.signal(number, exit_at_once if last else before)


def heed(number: int) -> None:
    """Let a signal raise `Interrupted` from now on, even if it was ignored."""
    signal.signal(number, _interrupt)


def exit_code(interruption: KeyboardInterrupt) -> int:
    """What to exit with after an interruption."""
    return interruption.code if isinstance(interruption, Interrupted) else 128 + signal.SIGINT


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    for each in SIGNALS:
        if signal.getsignal(each) == _interrupt:
            signal.signal(each, _end_at_once)
    raise Interrupted(number)


def _end_at_once(number: int, frame: Any) -> NoReturn:
    shown = _SHOW_CURSOR if sys.stderr is not None and sys.stderr.isatty() else ""  # a progress bar hides it
    os.write(2, f"{shown}interrupted twice: ended at once; every finished run is kept\n".encode())
    os._exit(128 + number)
