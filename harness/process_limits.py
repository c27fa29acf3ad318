"""What a process asks of the system for itself: a session, an end with its parent, silence, and limits. Linux only."""

from __future__ import annotations

import ctypes
import faulthandler
import math
import os
import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER, _PR_GET_CHILD_SUBREAPER = 1, 36, 37


def isolate(output: int | None = None) -> None:
    """Make of this process, which has just begun, a child that can be ended with all that it starts, and is not heard.

    Parameters
    ----------
    output : descriptor of the file that takes what is printed; by default nothing does
    """
    if os.getsid(0) != os.getpid():
        os.setsid()
    die_with_parent()
    adopt_orphans()  # so that what it starts stays among its descendants as long as it lives
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent answers Ctrl-C
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # not as the parent answers it
    faulthandler.disable()  # it would print the stack of the process that this one was forked from
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    for stream in (1, 2):
        os.dup2(nowhere if output is None else output, stream)
    os.close(nowhere)


def limit(*, memory: int | None = None, output: int | None = None, cpu: float | None = None) -> None:
    """Limit what this process may take from now on; a limit that it had already is not raised. No core dump is written.

    Parameters
    ----------
    memory : B of address space, beyond what it has
    output : B of any file that it writes; what goes beyond is an error of the writer
    cpu : s of CPU time, beyond what it has used; can be set again
    """
    _lower(resource.RLIMIT_CORE, 0)
    if output is not None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        _lower(resource.RLIMIT_FSIZE, output)
    if memory is not None:
        _lower(resource.RLIMIT_AS, _address_space() + memory)
    if cpu is not None:
        used = resource.getrusage(resource.RUSAGE_SELF)
        _lower(resource.RLIMIT_CPU, math.ceil(used.ru_utime + used.ru_stime + cpu), for_good=False)


def limit_memory_of_plugin() -> None:
    """Let this process take no more than half of what the machine has, where nobody says what code may take."""
    limit(memory=_half_of_machine())


@contextmanager
def memory_of_plugin_limited() -> Iterator[None]:
    """As `limit_memory_of_plugin`, until the end of this context."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    _lower(resource.RLIMIT_AS, _address_space() + _half_of_machine(), for_good=False)
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Until the end of this context no SIGINT reaches this thread; what is started meanwhile never gets any."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def adopt_orphans(wanted: bool = True) -> None:
    """Let what the children of this process leave behind become its own, so that it can be ended; or no longer."""
    _prctl(_PR_SET_CHILD_SUBREAPER, int(wanted))


def adopts_orphans() -> bool:
    """Whether this process does."""
    answer = ctypes.c_int(0)
    _prctl(_PR_GET_CHILD_SUBREAPER, ctypes.byref(answer))
    return bool(answer.value)


def die_with_parent(wanted: bool = True) -> None:
    """Ask the kernel to end this process when the thread that started it ends, however that happens; or no longer."""
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL if wanted else 0)


def _lower(what: int, most: int, *, for_good: bool = True) -> None:
    _, hard = resource.getrlimit(what)
    most = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(what, (most, most if for_good else hard))


def _half_of_machine() -> int:
    """B of memory."""
    return os.sysconf("SC_PHYS_PAGES") * resource.getpagesize() // 2


def _address_space() -> int:
    """B of address space that this process has now, or 0 where the system does not say."""
    try:
        with open("/proc/self/statm", encoding="ascii") as statm:
            return int(statm.read().split()[0]) * resource.getpagesize()
    except OSError:
        return 0


def _prctl(option: int, value: object) -> None:
    ctypes.CDLL(None).prctl(option, value)


# B of addresses; at 600 MB a command said that there was no memory, at 500 MB it waited for ever.
_LIBRARIES_NEED = 640 * 2**20
# What the system says of a library that it has no memory for.
_OUT_OF_MEMORY = ("failed to map segment", "annot allocate memory")


def has_room_for_libraries() -> bool:
    """Whether this process may take what libraries of linear algebra need to be loaded.

    With less, OpenBLAS asks for memory again and again, and neither ends nor fails.
    """
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    return most == resource.RLIM_INFINITY or most >= _LIBRARIES_NEED


def out_of_memory(error: BaseException | None) -> bool:
    """Whether an error, or one that it was raised from, says that there is no memory."""
    while error is not None and not isinstance(error, MemoryError):
        if any(words in str(error) for words in _OUT_OF_MEMORY):
            return True
        error = error.__cause__ or error.__context__
    return error is not None
