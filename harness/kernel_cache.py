"""Where compiled kernels are kept, and that nothing about a file can keep a kernel from being compiled.

A folder may be missing, read-only or on a full disk, and a power cut may leave a file cut short: then a kernel is
compiled anew. Of processes that need a kernel at one moment, one compiles it, and the others wait for its file.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from time import monotonic, sleep
from typing import Any

PACKAGE = Path(__file__).resolve().parent
# s that a process waits for another to compile a kernel, which may have been stopped over it.
LONGEST_WAIT = 120.0


def user_cache() -> Path | None:
    """The folder of this program in the user's cache; None for a user without a home."""
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "harness"
    except RuntimeError:
        return None


@contextmanager
def own_cache(module: str) -> Iterator[str]:
    """Keep what is compiled in a folder of these very sources.

    numba looks only at the file of a kernel to tell whether it is stale, and would go on running old code of another
    file that was inlined into it. So a folder belongs to the sources of a module and of all that it imports.

    Parameters
    ----------
    module : the name of the module in which the kernel stands

    Yields
    ------
    str
        The folder; empty where there is none.
    """
    import numba

    config: Any = numba.config
    theirs = config.CACHE_DIR
    config.CACHE_DIR = theirs or _folder(module) or ""
    try:
        yield str(config.CACHE_DIR)
    finally:
        config.CACHE_DIR = theirs


def forgiving(dispatcher: Any) -> Any:
    """Let a compiled function do without its file in the cache, where that cannot be written or holds no whole kernel.

    numba itself raises there.
    """
    kept = dispatcher._cache
    load, save = kept.load_overload, kept.save_overload
    function = dispatcher.py_func
    compiling = _Turn(kept.cache_path, f"{function.__module__}.{function.__qualname__}")

    def on_disk(signature: Any, context: Any) -> Any:
        try:
            return load(signature, context)
        except Exception:
            with suppress(Exception):
                kept.flush()
            return None

    def load_overload(signature: Any, context: Any) -> Any:
        found = on_disk(signature, context)
        if found is None:
            compiling.wait()
            found = on_disk(signature, context)  # which another may have made meanwhile
            if found is not None:
                compiling.end()
        return found

    def save_overload(signature: Any, compiled: Any) -> None:
        try:
            with suppress(OSError):
                save(signature, compiled)
        finally:
            compiling.end()

    kept.load_overload, kept.save_overload = load_overload, save_overload
    return dispatcher


class _Turn:
    """The turn of one process to compile a kernel: a byte of a file, locked. It ends with the process at the latest.

    Such a lock is the process's own, so that a kernel that calls itself does not wait for itself.

    Parameters
    ----------
    folder : of the kernel's file
    name : of the kernel
    """

    def __init__(self, folder: str, name: str) -> None:
        self._file, self._byte = os.path.join(folder, "compiling"), zlib.crc32(name.encode())

    def wait(self) -> None:
        """Wait for the turn, but not for ever; where nothing can be locked, it has come."""
        deadline = monotonic() + LONGEST_WAIT
        with suppress(OSError):
            os.makedirs(os.path.dirname(self._file), exist_ok=True)
            file = _opened(self._file)
            while monotonic() < deadline:
                try:
                    fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, self._byte)
                    return
                except (BlockingIOError, PermissionError):  # another has it
                    sleep(0.02)

    def end(self) -> None:
        """Let others have it."""
        with suppress(OSError):
            fcntl.lockf(_opened(self._file), fcntl.LOCK_UN, 1, self._byte)


@cache
def _opened(file: str) -> int:
    """The file of the locks, opened once: a process loses all locks of a file when it closes it anywhere."""
    return os.open(file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)


# "from a.b import c, d", its names in brackets over several lines or not
_IMPORT = re.compile(r"^[ \t]*from (harness[\w.]*) import (\([^)]*\)|[^\n]*)", re.MULTILINE)


@cache
def _folder(module: str) -> str | None:
    sources = hashlib.sha256()
    for file in sorted({PACKAGE / "kernel.py", *all_sources(module)}):
        sources.update(file.read_bytes())
    name = f"kernels-{sources.hexdigest()[:16]}"
    for folder in (PACKAGE / "__pycache__", user_cache()):
        if folder is not None and _takes_files(folder / name):
            return str(folder / name)
    return None


def all_sources(module: str) -> set[Path]:
    """The files of a module and of all in this package that it imports, over any number of steps.

    A module of another package may have inlined anything of this package.
    """
    if _source(module) is None:
        return set(PACKAGE.rglob("*.py"))
    found: set[Path] = set()
    ahead = [module]
    while ahead:
        file = _source(ahead.pop())
        if file is not None and file not in found:
            found.add(file)
            ahead += _imported(file)
    return found


@cache
def _imported(file: Path) -> tuple[str, ...]:
    """What a file imports of this package; a name may be a module or stand in one."""
    names: list[str] = []
    for package, listed in _IMPORT.findall(file.read_text(encoding="utf-8")):
        names += [package, *(f"{package}.{name}" for name in re.findall(r"\w+", listed))]
    return tuple(names)


def _source(module: str) -> Path | None:
    """The file of a module of this package."""
    place = PACKAGE.joinpath(*module.split(".")[1:])
    if not module.startswith(f"{PACKAGE.name}."):
        return None
    return next((file for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file()), None)


def _takes_files(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)
