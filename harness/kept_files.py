"""Small files kept between commands in the user's cache, each named by a hash of all that it was made from.

So none is ever stale. A file appears whole or not at all, also when its process is killed; where files cannot be kept,
what they hold is made anew.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from io import BytesIO
from pathlib import Path
from time import time
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

from harness.kernel_cache import user_cache

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNUSED = 30 * 86400.0  # s after which a file that was not used is removed


def folder(kind: str) -> Path | None:
    """Where files of a kind are kept: in the user's cache, where there is one."""
    cache = user_cache()
    return None if cache is None else cache / kind


def kept(kind: str, name: str) -> bytes | None:
    """What a file holds; None if it is not kept."""
    place_of_kind = folder(kind)
    if place_of_kind is not None:
        with suppress(OSError):
            content = (place_of_kind / name).read_bytes()
            os.utime(place_of_kind / name)
            return content
    return None


def keep(kind: str, name: str, content: bytes) -> None:
    """Keep a file, where there is a folder for it and room."""
    place_of_kind = folder(kind)
    if place_of_kind is not None:
        with suppress(OSError):  # no room, or larger than a run may write
            _keep(place_of_kind / name, content)


def kept_arrays(kind: str, name: str) -> dict[str, NDArray[Any]] | None:
    """The arrays in a file; None if it is not kept."""
    import numpy as np

    content = kept(kind, name)
    if content is not None:
        with (
            suppress(OSError, ValueError, BadZipFile, EOFError),
            np.load(BytesIO(content), allow_pickle=False) as found,
        ):
            return {key: found[key] for key in found.files}
    return None


def keep_arrays(kind: str, name: str, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Keep arrays in a file, as `keep` does."""
    import numpy as np

    content = BytesIO()
    np.savez(content, **dict[str, Any](arrays))
    keep(kind, name, content.getvalue())


def _keep(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    _remove_unused(path.parent)
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


@cache
def _remove_unused(home: Path) -> None:
    """Once in a process, at the first file that it keeps there."""
    oldest = time() - UNUSED
    with suppress(OSError), os.scandir(home) as found:  # of 10 000 files, paths of `pathlib` take twice as long
        for old in found:
            with suppress(OSError):
                if old.stat().st_mtime < oldest:
                    os.unlink(old)
