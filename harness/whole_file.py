"""Files that are written whole or not at all: a full disk, or the end of the process, leaves no half of one behind."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from pathlib import Path


def write_whole(path: Path, content: str | bytes, *, replace: bool = True) -> None:
    """Write a file; the folders above it are made. What was there stays as it was until all of the new is on the disk.

    Parameters
    ----------
    path : of the file; what is no regular file, such as /dev/stdout, is written to as it stands
    content : text is written as UTF-8, its line ends as they are
    replace : whether a file that is there may be overwritten

    Raises
    ------
    FileExistsError
        If the file is there and may not be overwritten.
    OSError
        If it cannot be written.
    """
    data = content.encode() if isinstance(content, str) else content
    path.parent.mkdir(parents=True, exist_ok=True)
    if not replace:
        _write_new(path, data)
    elif path.exists() and not (path.is_file() and os.access(path.resolve().parent, os.W_OK)):
        path.write_bytes(data)
    else:
        _replace(path.resolve(), data)


def require_writable(folder: Path) -> None:
    """Make a folder and try to write into it; nothing is left of that.

    Raises
    ------
    OSError
        If it cannot be made, or takes no files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryFile(prefix=".harness-", dir=folder) as file:
            file.write(b"x")
    except OSError as error:
        error.filename = str(folder)
        raise


def _write_new(path: Path, data: bytes) -> None:
    with path.open("xb") as file:
        try:
            file.write(data)
            file.flush()
        except BaseException:
            path.unlink()
            raise


def _replace(path: Path, data: bytes) -> None:
    mode = path.stat().st_mode & 0o777 if path.exists() else 0o666 & ~_umask()
    handle, name = tempfile.mkstemp(prefix=".harness-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(name, mode)
        os.replace(name, path)
    except BaseException as error:
        with suppress(OSError):
            os.unlink(name)
        if isinstance(error, OSError):
            error.filename = str(path)
        raise


def _umask() -> int:
    """Which can be asked for only by setting it."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
