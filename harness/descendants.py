"""What a process has started, and all that those have started in turn."""

from __future__ import annotations

import os
import resource
import time
from contextlib import suppress

import psutil


def cpu_time_of_descendants() -> float:
    """s of CPU time that what this process has started has used so far, whether it still runs or was waited for."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    total = ended.ru_utime + ended.ru_stime
    for process in descendants(os.getpid()):
        with suppress(psutil.Error):
            used = process.cpu_times()
            total += used.children_user + used.children_system
            total += _on_processors(process.pid) or used.user + used.system
    return total


def _on_processors(process: int) -> float:
    """s that a process has run, to the nanosecond, where other accounts count ticks; 0 where the kernel keeps none."""
    total = 0
    with suppress(OSError):
        for task in os.listdir(f"/proc/{process}/task"):
            with open(f"/proc/{process}/task/{task}/schedstat", encoding="ascii") as account:
                total += int(account.read().split()[0])
    return 1e-9 * total


def kill_descendants(process: int) -> None:
    """Kill all that a process has started: again and again, since what is not dead yet may start more."""
    rounds = 0  # one after another in which nothing was left to kill
    with suppress(psutil.NoSuchProcess):
        while rounds < 2:  # a list that is read while a process ends may lack another
            if sum(_killed(started) for started in descendants(process)):
                rounds = 0
                time.sleep(0.001)
            else:
                rounds += 1


def descendants(process: int) -> list[psutil.Process]:
    """Those of a process, as the kernel lists them; psutil looks at every process of the machine, which takes long."""
    found, ahead = [], [process]
    while ahead:
        try:
            tasks = os.listdir(f"/proc/{(parent := ahead.pop())}/task")
            for task in tasks:
                with open(f"/proc/{parent}/task/{task}/children", encoding="ascii") as listed:
                    children = [int(number) for number in listed.read().split()]
                ahead += children
                for child in children:
                    with suppress(psutil.NoSuchProcess):
                        found.append(psutil.Process(child))
        except OSError:  # it has ended, or this kernel lists none
            if parent == process:
                return psutil.Process(process).children(recursive=True)
    return found


def _killed(process: psutil.Process) -> bool:
    """Whether there was a process left to kill: it may have ended, or not be ours to end."""
    try:
        process.kill()
        return bool(process.status() != psutil.STATUS_ZOMBIE)
    except psutil.Error:
        return False
