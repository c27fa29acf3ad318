"""A child process that can harm neither this one nor the machine: limited, silenced, awaited with a deadline, ended.

A child is forked from this process (`Child.fork`) or is a program of its own (`Child.spawn`). It leads a session, so
that it can be killed with what it starts, ends when its parent does, and speaks in messages: bytes behind their length,
of which nothing but that length is trusted. What a child that has ended left in a session of its own is ended where the
parent adopts orphans, as a process should whose only work is to run others.
"""

from __future__ import annotations

import math
import os
import signal
import socket
import struct
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from types import TracebackType
from typing import Literal, NoReturn

from harness.descendants import kill_descendants
from harness.process_limits import adopts_orphans, isolate
from harness.python_child import start_module

_LENGTH = struct.Struct("!Q")
_CHUNK = 2**20
MOST_BYTES = 2**31
"""B that may wait in a socket for this process to take them; no message is longer."""

LONGEST_WAIT = 1e6
"""s that the system can be asked to wait at once; whoever waits longer asks again."""

NoMessage = Literal["ended", "timeout", "stopped"]
"""Why there is no message: the child has ended, it did not answer in time, or the one who waits was told to stop."""


@dataclass(frozen=True)
class Ending:
    """How a process ended.

    Parameters
    ----------
    code : its exit code; of a process that a signal ended, the number of the signal below 0

    >>> print(Ending(3), Ending(-11), sep=", ")
    exit code 3, signal 11 (SIGSEGV)
    """

    code: int

    @property
    def signal(self) -> int:
        """The number of the signal that ended it; 0 if none did."""
        return max(0, -self.code)

    @property
    def killed(self) -> bool:
        """Whether it was killed, as a system does that runs out of memory."""
        return self.signal == signal.SIGKILL

    @property
    def signal_name(self) -> str:
        """SIGSEGV for 11; real-time signals have no name."""
        return signal.Signals(self.signal).name if self.signal in set(signal.Signals) else "a real-time signal"

    def __str__(self) -> str:
        return f"signal {self.signal} ({self.signal_name})" if self.signal else f"exit code {self.code}"

    def instead_of(self, expected: str) -> str:
        """What to tell of a process that was to give something first.

        >>> Ending(3).instead_of("a result")
        'ended without a result, exit code 3'
        """
        if self.killed:
            return "killed by the system (signal 9), most likely because memory ran out"
        return f"ended by {self}" if self.signal else f"ended without {expected}, {self}"


class Channel:
    """Messages through a socket, as a child has them.

    Parameters
    ----------
    connection : the child's socket, or its descriptor
    """

    def __init__(self, connection: socket.socket | int) -> None:
        self._socket = socket.socket(fileno=connection) if isinstance(connection, int) else connection

    def send(self, content: bytes) -> None:
        """Send a message."""
        _send(self._socket, content)

    def receive(self) -> bytes | None:
        """The next message, whenever it comes; None if the parent has closed its end."""
        head = self._exactly(_LENGTH.size)
        return None if head is None else self._exactly(_LENGTH.unpack(head)[0])

    def _exactly(self, size: int) -> bytes | None:
        content = bytearray()
        while len(content) < size:
            chunk = self._socket.recv(min(_CHUNK, size - len(content)))
            if not chunk:
                return None
            content += chunk
        return bytes(content)


def _send(connection: socket.socket, content: bytes) -> None:
    head = _LENGTH.pack(len(content))
    if len(content) > _CHUNK:  # a large one is not copied
        connection.sendall(head)
        connection.sendall(content)
    else:  # the other side wakes up once
        connection.sendall(head + content)


class Child:
    """A child process, as its parent has it. A context: leaving it ends the child and everything that it started.

    Made by `fork` or `spawn`.
    """

    def __init__(self, pid: int, connection: socket.socket) -> None:
        self.pid = pid
        self._socket, self._received = connection, bytearray()
        self._descriptor = os.pidfd_open(pid)  # becomes readable when the process ends
        self._program: subprocess.Popen[bytes] | None = None
        self._ending: Ending | None = None

    @classmethod
    def fork(cls, main: Callable[[Channel], None], output: int | None = None) -> Child:
        """Run a function in a copy of this process, which ends with it, whatever happens.

        Parameters
        ----------
        main : what the child does; what it raises is printed, and its exit code is then 1
        output : descriptor of the file that takes what the child prints; by default nothing does
        """
        ours, theirs = socket.socketpair()
        parent = os.getpid()
        for stream in (sys.stdout, sys.stderr):  # else the child would print what waits there once more
            with suppress(AttributeError, ValueError, OSError):
                stream.flush()
        pid = os.fork()
        if pid == 0:
            ours.close()
            _run(main, theirs, parent, output)
        theirs.close()
        return cls(pid, ours)

    @classmethod
    def spawn(
        cls, module: str, arguments: Sequence[str], environment: Mapping[str, str], folder: str | None = None
    ) -> Child:
        """Start a module of this program in an interpreter of its own, which must call `isolate` first of all.

        Parameters
        ----------
        module : its name
        arguments : that follow the descriptor of the child's channel, the first argument
        environment : variables of the child
        folder : that it starts in; by default that of this process
        """
        ours, theirs = socket.socketpair()
        with theirs:
            program = start_module(module, theirs, arguments, environment, folder=folder, silent=True)
        child = cls(program.pid, ours)
        child._program = program
        return child

    def __enter__(self) -> Child:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()

    @property
    def unread(self) -> bool:
        """Whether a part of a message has come, and not all of it."""
        return bool(self._received)

    def send(self, content: bytes) -> None:
        """Send a message to a child that waits for one; whether it has ended is seen by `receive`."""
        with suppress(ConnectionError):
            _send(self._socket, content)

    def ask(self, content: bytes, seconds: float) -> bytes | NoMessage:
        """Send a message and wait for one, as `receive` does."""
        deadline = time.monotonic() + seconds
        self._socket.settimeout(seconds)
        try:
            _send(self._socket, content)
        except TimeoutError:
            return "timeout"
        except ConnectionError:
            pass  # it has closed its end: whether it ends as well is seen below
        finally:
            self._socket.settimeout(None)
        return self.receive(max(0.0, deadline - time.monotonic()))

    def receive(self, seconds: float, stop: Connection | None = None) -> bytes | NoMessage:
        """The next message of the child, or why there is none.

        Parameters
        ----------
        seconds : to wait for it at the most
        stop : a connection on which something comes, or whose other side closes, when waiting is of no use any more
        """
        deadline = time.monotonic() + seconds
        waiting: list[socket.socket | Connection | int] = [self._socket, self._descriptor]
        if stop is not None:
            waiting.append(stop)
        while True:
            message = self._message()
            if message is not None:
                return message
            left = max(0.0, deadline - time.monotonic())
            ready = wait(waiting, timeout=min(left, LONGEST_WAIT))
            if stop in ready:
                return "stopped"
            if self._descriptor in ready:
                while self._take():
                    pass
                message = self._message()
                return "ended" if message is None else message
            if not ready and left > LONGEST_WAIT:
                continue
            if not ready:
                return "timeout"
            if not self._take():
                waiting.remove(self._socket)  # it has closed its end; how it ends is still to be seen

    def _take(self) -> bool:
        """Take what has come; False where nothing has, nothing more can, or more than any message needs has."""
        try:
            chunk = self._socket.recv(_CHUNK, socket.MSG_DONTWAIT)
        except (BlockingIOError, ConnectionError):
            return False
        self._received += chunk
        return bool(chunk) and len(self._received) <= MOST_BYTES

    def _message(self) -> bytes | None:
        """The first whole message of what has come."""
        if len(self._received) < _LENGTH.size:
            return None
        end = _LENGTH.size + _LENGTH.unpack_from(self._received)[0]
        if len(self._received) < end:
            return None
        content = bytes(memoryview(self._received)[_LENGTH.size : end])
        del self._received[:end]
        return content

    def end(self) -> Ending:
        """Kill what is left of the child and of everything that it started; how the child itself ended."""
        if self._ending is None:
            self._ending = end(self.pid)
            os.close(self._descriptor)
            self._socket.close()
            if self._program is not None:
                self._program.returncode = self._ending.code  # it need not be waited for again
        return self._ending


def guarded(main: Callable[[Channel], None]) -> Callable[[Channel], None]:
    """What a child does so that nothing that `main` starts outlives it, however it ends: `main`, in a child of its own.

    For processes with several children, which therefore adopt no orphans. The child adopts what `main` leaves behind,
    ends it, and then itself as `main` has ended.

    Parameters
    ----------
    main : as for `Child.fork`; what is sent through its channel is sent to the parent of both
    """

    def guard(channel: Channel) -> None:
        with Child.fork(lambda _: main(channel)) as child:
            child.receive(math.inf)
            ending = child.end()
        if ending.signal:
            with suppress(OSError):  # SIGKILL is never answered
                signal.signal(ending.signal, signal.SIG_DFL)
            os.kill(os.getpid(), ending.signal)
        os._exit(ending.code)

    return guard


def end(child: int) -> Ending:
    """Kill what is left of a child, by its process id, and of everything that it started; reap it.

    A process that adopts orphans must have no other child: what it adopts is taken for this one's.
    """
    adopting = adopts_orphans()
    if not adopting:  # an orphan would be out of reach: first what the child started, while it can start no more
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGSTOP)
        kill_descendants(child)
    for kill in (os.killpg, os.kill):  # the group exists once the child leads its session
        with suppress(ProcessLookupError):
            kill(child, signal.SIGKILL)
    ending = Ending(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    while adopting:  # what it left behind has become ours, and what that leaves behind in turn
        try:
            ended, _ = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            break
        if not ended:
            kill_descendants(os.getpid())
            os.waitpid(-1, 0)
    return ending


def _run(main: Callable[[Channel], None], connection: socket.socket, parent: int, output: int | None) -> NoReturn:
    """What a forked child does; it never returns, whatever happens."""
    code = 1
    try:
        isolate(output)
        if output is not None:
            os.close(output)
        # what prints through Python may have been led elsewhere in the parent, as in a notebook
        sys.stdout, sys.stderr = (
            os.fdopen(stream, "w", 1, encoding="utf-8", errors="backslashreplace", closefd=False) for stream in (1, 2)
        )
        if os.getppid() == parent:  # else it has ended already
            main(Channel(connection))
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        with suppress(BaseException):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)
