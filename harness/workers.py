"""Child processes that share out work: long tasks that need nothing of each other, several at a time.

Every task is a function of this process, known to the children because they are forked from it; only what comes of it
is sent. What a task starts is ended with it.
"""

from __future__ import annotations

import os
import pickle
import traceback
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from typing import Any, TypeVar

from harness.child_process import Channel, Child, NoMessage, guarded
from harness.errors import InputError
from harness.process_limits import adopt_orphans

Result = TypeVar("Result")

# s between two looks at a child that works: tasks take seconds.
_LOOK = 0.02


def usable_cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def shared_out(
    tasks: Sequence[Callable[[], Result]], workers: int, begin: Callable[[int], object] = lambda place: None
) -> Generator[tuple[int, Result], None, None]:
    """What comes of each task, with its place, as soon as it is there.

    Parameters
    ----------
    tasks : begun in this order
    workers : child processes, at the most; what one has imported and compiled serves all that it does
    begin : told the place of a task that begins

    Raises
    ------
    InputError
        That a task has raised.
    RuntimeError
        If a task raised anything else, or its process ended.

    >>> sorted(shared_out([lambda: "a", lambda: "b", lambda: "c"], workers=2))
    [(0, 'a'), (1, 'b'), (2, 'c')]
    """
    left = iter(range(len(tasks)))
    busy: dict[Child, int] = {}
    with ExitStack() as children:
        for _ in range(min(workers, len(tasks))):
            child = children.enter_context(Child.fork(guarded(partial(_serve, tasks))))
            _next(child, left, busy, begin)
        while busy:
            for child, place in list(busy.items()):
                answer = child.receive(_LOOK)
                if answer == "timeout":
                    continue
                result = _result(answer, child)
                _next(child, left, busy, begin)
                yield place, result


def _next(child: Child, left: Iterator[int], busy: dict[Child, int], begin: Callable[[int], object]) -> None:
    """Give a child its next task, if there is one."""
    busy.pop(child, None)
    place = next(left, None)
    if place is not None:
        begin(place)
        busy[child] = place
        child.send(pickle.dumps(place))


def _result(answer: bytes | NoMessage, child: Child) -> Any:
    """What a child has sent, or what has become of it."""
    if not isinstance(answer, bytes):
        raise RuntimeError(child.end().instead_of("a result"))
    result = pickle.loads(answer)
    if isinstance(result, InputError | RuntimeError):
        raise result
    return result


def _serve(tasks: Sequence[Callable[[], Result]], channel: Channel) -> None:
    """What a child does: one task after another, until its parent closes its end."""
    adopt_orphans(False)  # it may have several children; the guard around it adopts what they leave
    while (asked := channel.receive()) is not None:
        try:
            answer = pickle.dumps(tasks[pickle.loads(asked)]())
        except InputError as error:
            answer = pickle.dumps(error)
        except Exception:
            answer = pickle.dumps(RuntimeError(f"in a process that shares the work:\n{traceback.format_exc()}"))
        channel.send(answer)
