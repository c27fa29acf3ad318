"""References kept between runs: one file each, named by a hash of what it was made from, so that none is ever stale.

The points of a sweep share them, whichever process makes one first. Where files cannot be kept, references are made
anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from harness import kept_files

Arrays = Mapping[str, NDArray[Any]]
_KIND = "references"


def folder() -> Path | None:
    """Where references are kept: in the user's cache, where there is one."""
    return kept_files.folder(_KIND)


def kept(key: str, make: Callable[[], Arrays]) -> Arrays:
    """The reference of this name, made where it is not kept yet."""
    found = kept_files.kept_arrays(_KIND, f"{key}.npz")
    if found is not None:
        return found
    made = make()
    kept_files.keep_arrays(_KIND, f"{key}.npz", made)
    return made
