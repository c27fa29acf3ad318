"""What this program runs with, as one text that changes with it: its sources, the interpreter, what can be imported.

What was made of them may be kept between commands under such a name, and is never stale.
"""

from __future__ import annotations

import hashlib
import os
import sys
from functools import cache, lru_cache

from harness.kernel_cache import PACKAGE


def installed() -> str:
    """A hash of the sources of this program, of the interpreter, and of all that `sys.path` offers to import."""
    return hashlib.sha256(f"{sources_hash()} {sys.version} {importable(tuple(sys.path))}".encode()).hexdigest()


def version_of(package: str) -> str | None:
    """The version of an installed package; None for one that is missing."""
    return _version_on(tuple(sys.path), package)


@lru_cache(maxsize=256)
def _version_on(path: tuple[str, ...], package: str) -> str | None:
    """On one `sys.path`: finding it takes milliseconds, since all that its package says of itself is read."""
    from importlib.metadata import PackageNotFoundError, version  # which few commands need

    try:
        return version(package)
    except PackageNotFoundError:
        return None


@lru_cache(maxsize=8)
def importable(path: tuple[str, ...]) -> str:
    """A hash of the names of all modules and installed versions that the folders of a `sys.path` hold.

    The folders are looked at once a process.
    """
    names = "\n\n".join("\n".join(_in_folder(folder)) for folder in path)
    return hashlib.sha256(names.encode("utf-8", "surrogateescape")).hexdigest()


def _in_folder(folder: str) -> list[str]:
    try:
        names = sorted(os.listdir(folder))
    except OSError:  # an archive, or nothing
        return []
    ends = (".py", ".so", ".pth", "-info")
    return [
        name
        for name in names
        if name.endswith(ends) or ("." not in name and os.path.exists(os.path.join(folder, name, "__init__.py")))
    ]


@cache
def sources_hash() -> str:
    """A hash of the sources of this program alone."""
    sources = hashlib.sha256()
    for folder, folders, names in os.walk(PACKAGE):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        for name in sorted(names):
            if name.endswith(".py"):
                place = os.path.join(folder, name)
                with open(place, "rb") as file:
                    content = file.read()
                sources.update(f"{os.path.relpath(place, PACKAGE)} {len(content)}\n".encode() + content)
    return sources.hexdigest()
