"""References kept between runs: one file each, named by a hash of what it was made from, so that none is ever stale.

The points of a sweep share them, whichever process makes one first. A file appears whole or not at all, also when its
process is killed. Where files cannot be kept, references are made anew.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from time import time
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from harness.kernel_cache import user_cache

Arrays = Mapping[str, NDArray[Any]]

UNUSED = 30 * 86400.0  # s after which a reference that was not used is removed


def folder() -> Path | None:
    """Where references are kept: in the user's cache, where there is one."""
    cache = user_cache()
    return None if cache is None else cache / "references"


def kept(key: str, make: Callable[[], Arrays]) -> Arrays:
    """The reference of this name, made where it is not kept yet."""
    home = folder()
    if home is None:
        return make()
    path = home / f"{key}.npz"
    with suppress(OSError, ValueError, BadZipFile, EOFError), np.load(path) as found:
        arrays = {name: found[name] for name in found.files}
        os.utime(path)
        return arrays
    made = make()
    with suppress(OSError):  # no home, no room, or larger than a run may write: then it is made again
        _keep(path, made)
    return made


def _keep(path: Path, arrays: Arrays) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    for old in path.parent.glob("*"):
        with suppress(OSError):
            if old.stat().st_mtime < time() - UNUSED:
                old.unlink()
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, **dict[str, Any](arrays))
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
