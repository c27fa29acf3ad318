"""Runs on the workers of a Dask cluster: the same isolated runs, one a worker slot at a time.

A worker keeps warm servers of its own, as a sweep on one machine does; only the sweeping process writes results. The
runs of a worker that dies are done by another. Needs the extra `cluster`.
"""

from __future__ import annotations

import asyncio
import logging
import resource
import signal
import socket
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime, timezone
from functools import cache
from time import monotonic
from types import TracebackType
from typing import TYPE_CHECKING, Any

from harness.backends.registry import packages
from harness.errors import InputError
from harness.installed import sources_hash
from harness.measure.machine import fingerprint, machine_facts, package_versions
from harness.runner.executor import FinishedJob
from harness.runner.schedule import Job
from harness.runner.servers import Servers, task_of
from harness.runner.task import Report, Task
from harness.scene.mesh import Mesh
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene_files import Opened, SceneFiles

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT_TIMEOUT = 30.0  # s for the scheduler to answer
WORKER_TIMEOUT = 120.0  # s for the first worker to join
AHEAD = 2  # jobs handed out for each slot, so that no slot waits for the next
DEATHS = 5  # workers that die with the same run, until the run is taken for the reason
LOOK_EVERY = 5.0  # s between checks of which workers there are
LOCAL = "local:"
FILES, FILES_A_WORKER = 48, 16  # that the sweeping process opens


class Cluster:
    """Does the jobs of a sweep on the workers of a Dask scheduler.

    Parameters
    ----------
    address : of a scheduler, `tcp://host:port`; or `local:N` for N workers on this machine

    Raises
    ------
    InputError
        The extra is not installed, no scheduler answers, or a worker runs another version of the program.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._option = f"--cluster {address}"
        self._open = ExitStack()
        self._known: set[str] = set()
        self._slots: Counter[str] = Counter()  # by machine, of all workers that there ever were
        self._sent: dict[Future, Job] = {}
        self._last_seen = monotonic()

    def __enter__(self) -> Cluster:
        try:
            self._client = self._connect()
            try:
                self._client.wait_for_workers(1, timeout=WORKER_TIMEOUT)
            except TimeoutError as error:
                raise InputError(f"{self._option}: no worker joined in {WORKER_TIMEOUT:g} s") from error
            self._look()
        except BaseException:
            self._open.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None and self._sent:  # the results of these runs are not wanted any more
            with suppress(Exception):
                self._client.cancel(list(self._sent), force=True)
                self._client.run(stop_here, on_error="ignore")
        self._open.close()

    def run(self, jobs: Iterable[Job], meshes: Opened, before: Callable[[Job], None]) -> Iterator[FinishedJob]:
        """See `harness.runner.executor.Executor`; `before` is called when a job is handed out.

        Raises
        ------
        InputError
            The scheduler is lost, a worker cannot do these runs, or there has been none for too long.
        """
        try:
            yield from self._run(jobs, meshes, before)
        except (OSError, asyncio.CancelledError, CancelledError) as error:  # as Dask says that a connection is gone
            self._sent.clear()  # nobody is there to end them, or to say what became of them
            raise InputError(
                f"{self._option}: the connection to the scheduler was lost; every finished run is kept, and the same "
                "command does the rest"
            ) from error

    def _run(self, jobs: Iterable[Job], meshes: Opened, before: Callable[[Job], None]) -> Iterator[FinishedJob]:
        waiting = deque(jobs)
        contents: dict[str, Future] = {}
        while waiting or self._sent:
            slots = self._look()
            while waiting and len(self._sent) < AHEAD * max(1, slots):
                job = waiting.popleft()
                before(job)
                self._sent[self._submit(job, meshes, contents)] = job
            for future in self._finished():
                yield self._done(self._sent.pop(future), future)

    def _submit(self, job: Job, meshes: Opened, contents: dict[str, Future]) -> Future:
        task, files = task_of(job.experiment, job.point, meshes, recorded=job.recorded, on_demand=job.on_demand)
        for part in files.parts:
            if part.identity not in contents:
                # as a task, not as scattered data: it can be made again when the worker that holds it dies
                contents[part.identity] = self._client.submit(_itself, part, key=f"file-{part.identity}")
        return self._client.submit(run_here, task, *(contents[identity] for identity in files.identities), pure=False)

    def _finished(self) -> list[Future]:
        """Wait until some runs have ended; none after a while, so that one can look around."""
        from distributed import wait

        try:
            return list(wait(list(self._sent), timeout=LOOK_EVERY, return_when="FIRST_COMPLETED").done)
        except TimeoutError:
            return []

    def _done(self, job: Job, future: Future) -> FinishedJob:
        from distributed import KilledWorker

        try:
            outcome: WorkerReport = future.result()
        except KilledWorker as error:
            now, report = datetime.now(timezone.utc), Report("crashed", f"every worker that tried it died: {error}")
            return FinishedJob(job, report, timing_grade=False, started=now)
        alone = self._slots[outcome.host] == 1
        return FinishedJob(job, outcome.report, timing_grade=alone, started=outcome.started, machine=outcome.machine)

    def _look(self) -> int:
        """How many slots there are now; workers that have joined are checked first.

        Raises
        ------
        InputError
            A worker cannot do these runs, or there has been none for too long.
        """
        workers = self._client.scheduler_info(n_workers=-1)["workers"]
        new = workers.keys() - self._known
        if new:
            for address, theirs in self._ask(sorted(new)).items():
                self._check(address, theirs)
                self._known.add(address)
                self._slots[theirs.host] += workers[address]["nthreads"]
        if workers:
            self._last_seen = monotonic()
        elif monotonic() - self._last_seen > WORKER_TIMEOUT:
            raise InputError(
                f"{self._option}: there has been no worker for {WORKER_TIMEOUT:g} s; every finished run is kept, and "
                "the same command does the rest"
            )
        return sum(worker["nthreads"] for worker in workers.values())

    def _ask(self, addresses: list[str]) -> dict[str, Identity]:
        try:
            # one that has died meanwhile does not answer
            found = self._client.run(identity, workers=addresses, on_error="return")
        except (ModuleNotFoundError, AttributeError) as error:
            raise InputError(f"{self._option}: a worker lacks this program: {error}") from error
        for address, answer in found.items():
            if isinstance(answer, ModuleNotFoundError | AttributeError):
                raise InputError(f"{self._option}: the worker {address} lacks this program: {answer}")
        return {address: answer for address, answer in found.items() if isinstance(answer, Identity)}

    def _check(self, address: str, theirs: Identity) -> None:
        ours = identity()
        if theirs.sources != ours.sources:
            raise InputError(
                f"{self._option}: the worker {address} runs another version of harness (its sources hash to "
                f"{theirs.sources[:12]}, ours to {ours.sources[:12]}); install the same on both"
            )
        names = theirs.packages.keys() | ours.packages.keys()
        if other := sorted(name for name in names if theirs.packages.get(name) != ours.packages.get(name)):
            raise InputError(
                f"{self._option}: the worker {address} has other versions of {', '.join(other)}; install the same on "
                "both"
            )

    def _connect(self) -> Client:
        try:
            import dask
            from distributed import Client, LocalCluster
        except ImportError as error:
            raise InputError(f"{self._option} needs Dask: pip install 'harness[cluster]' ({error})") from error
        self._open.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": DEATHS}))
        if not self._address.startswith(LOCAL):
            try:
                return self._open.enter_context(Client(self._address, timeout=CONNECT_TIMEOUT))
            except (OSError, ValueError) as error:
                raise InputError(f"{self._option}: no scheduler answers: {error}") from error
        workers = int(self._address.removeprefix(LOCAL))
        _require_open_files(FILES + FILES_A_WORKER * workers, self._option)
        try:
            with _inherited_by_children(signal.SIGINT, signal.SIG_IGN):  # the sweeping process answers Ctrl-C
                cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    memory_limit=0,  # runs have limits of their own
                    dashboard_address=None,
                    silence_logs=logging.CRITICAL,
                )
        except (OSError, RuntimeError) as error:  # as Dask says that a process, or its files, cannot be had
            raise InputError(f"{self._option}: the workers cannot be started: {error}") from error
        self._open.enter_context(cluster)
        return self._open.enter_context(Client(cluster))


def _require_open_files(most: int, option: str) -> None:
    """Refuse what Dask would try for ever: it waits for a connection that it may not accept."""
    allowed, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if allowed != resource.RLIM_INFINITY and allowed < most:
        raise InputError(f"{option}: this needs {most} open files, and a process may have {allowed} here (`ulimit -n`)")


@contextmanager
def _inherited_by_children(number: signal.Signals, disposition: signal.Handlers) -> Iterator[None]:
    """How processes that are started meanwhile handle a signal; only a program's main thread can set that."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    ours = signal.signal(number, disposition)
    try:
        yield
    finally:
        signal.signal(number, ours)


@dataclass(frozen=True)
class Identity:
    """What a worker is: its machine, and what it would run."""

    host: str
    sources: str
    packages: Mapping[str, str]


@dataclass(frozen=True)
class WorkerReport:
    """A run on a worker, and where and when it was."""

    report: Report
    host: str
    machine: Mapping[str, Any]
    started: datetime


def identity() -> Identity:
    """Of the process that calls."""
    return Identity(socket.gethostname(), sources_hash(), package_versions(packages()))


def run_here(task: Task, *parts: Mesh | RecordedPoses) -> WorkerReport:
    """On a worker: one run in a process of its own, forked from a warm server of this slot."""
    started = datetime.now(timezone.utc)
    servers = _slots.setdefault(threading.get_ident(), Servers())
    return WorkerReport(servers.run(task, SceneFiles.of(parts)), socket.gethostname(), _machine(), started)


def stop_here() -> None:
    """On a worker: end the runs in flight."""
    for servers in list(_slots.values()):
        servers.interrupt()


# A slot is a thread of the worker. Its servers end when the worker does, for their sockets close then.
_slots: dict[int, Servers] = {}


@cache
def _machine() -> dict[str, Any]:
    """Facts of this machine with its name: machines of the same make are not the same machine."""
    facts = machine_facts() | {"host": socket.gethostname()}
    return facts | {"fingerprint": fingerprint(facts)}


def _itself(part: Mesh | RecordedPoses) -> Mesh | RecordedPoses:
    return part
