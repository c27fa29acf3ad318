"""Where compiled kernels are kept, and that nothing about a file can keep a kernel from being compiled.

A folder may be missing, read-only or on a full disk, and a power cut may leave a file cut short: then a kernel is
compiled anew.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

import numba

PACKAGE = Path(__file__).resolve().parent


def user_cache() -> Path | None:
    """The folder of this program in the user's cache; None for a user without a home."""
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "harness"
    except RuntimeError:
        return None


@contextmanager
def own_cache(rooms: Sequence[str]) -> Iterator[str]:
    """Keep what is compiled in a folder of these very sources.

    numba looks only at the file of a kernel to tell whether it is stale, and would go on running old code of another
    file that was inlined into it.

    Parameters
    ----------
    rooms : the packages in which kernels, and the constants that are compiled into them, stand

    Yields
    ------
    str
        The folder; empty where there is none.
    """
    config: Any = numba.config
    theirs = config.CACHE_DIR
    config.CACHE_DIR = theirs or _folder(tuple(rooms)) or ""
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

    def load_overload(signature: Any, context: Any) -> Any:
        try:
            return load(signature, context)
        except Exception:
            with suppress(Exception):
                kept.flush()
            return None

    def save_overload(signature: Any, compiled: Any) -> None:
        with suppress(OSError):
            save(signature, compiled)

    kept.load_overload, kept.save_overload = load_overload, save_overload
    return dispatcher


@cache
def _folder(rooms: tuple[str, ...]) -> str | None:
    sources = hashlib.sha256()
    for file in [
        PACKAGE / "kernel.py",
        *(file for room in rooms for file in sorted((PACKAGE / room).rglob("*.py"))),
    ]:
        sources.update(file.read_bytes())
    name = f"kernels-{sources.hexdigest()[:16]}"
    for folder in (PACKAGE / "__pycache__", user_cache()):
        if folder is not None and _takes_files(folder / name):
            return str(folder / name)
    return None


def _takes_files(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)
