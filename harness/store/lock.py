"""One sweep at a time on a results file: a lock that the system releases when its process dies, however it dies."""

from __future__ import annotations

import fcntl
import os
import socket
from contextlib import suppress
from pathlib import Path

from harness.errors import InputError


class SweepLock:
    """Held from construction to `release`, by this process: it keeps other processes out, children of this one too.

    It stands on a file of its own beside the database, because closing any other handle on the database itself would
    drop the locks that SQLite holds on it.

    Raises
    ------
    InputError
        Another process holds it, or its file cannot be written.
    """

    def __init__(self, database: Path) -> None:
        self._path = database.with_name(f"{database.name}-sweep")
        try:
            self._handle = self._acquire(database)
        except OSError as error:
            reason = f"cannot be written to: {error.strerror}. Give another file with --db"
            raise InputError(f"{database}: {reason}") from error

    def release(self) -> None:
        """Give the lock back and remove its file."""
        with suppress(OSError):  # a file that is left behind locks out no other sweep
            self._path.unlink()
        os.close(self._handle)

    def _acquire(self, database: Path) -> int:
        while True:
            handle = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o666)
            try:
                fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except (BlockingIOError, PermissionError) as error:
                holder = os.read(handle, 200).decode(errors="replace").strip() or "unknown"
                os.close(handle)
                raise InputError(
                    f"{database}: another sweep is writing to it ({holder}). Wait for its end, or give another file "
                    "with --db; nothing was changed"
                ) from error
            if self._is_still_there(handle):
                try:
                    os.ftruncate(handle, 0)
                    os.write(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
                except BaseException:  # the disk is full
                    self._path.unlink()
                    os.close(handle)
                    raise
                return handle
            os.close(handle)  # its holder removed it after it was opened here, and before it was locked

    def _is_still_there(self, handle: int) -> bool:
        try:
            return os.path.samestat(os.fstat(handle), os.stat(self._path))
        except FileNotFoundError:
            return False
