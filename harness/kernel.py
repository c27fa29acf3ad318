"""How every numerical kernel is compiled: once, kept on disk, one thread, strict floating point.

Division follows IEEE 754 (no exception on zero) and nothing is reordered, so that results are the same to the bit
wherever a kernel is inlined.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function over arrays, keeping its type for the checker."""
    with _own_cache():
        return cast(Function, numba.njit(cache=True, error_model="numpy")(function))


def inner(function: Function) -> Function:
    """A kernel that is written out where another calls it, for innermost loops.

    numba counts references to arrays at every real call, which made loops over neighbours four times slower.
    """
    return cast(Function, numba.njit(error_model="numpy", inline="always")(function))


@contextmanager
def _own_cache() -> Iterator[None]:
    """Keep what is compiled in a folder of these very sources.

    numba looks only at the file of a kernel to tell whether it is stale, and would go on running old code of another
    file that was inlined into it.
    """
    config: Any = numba.config
    theirs = config.CACHE_DIR
    config.CACHE_DIR = theirs or _cache_folder()
    try:
        yield
    finally:
        config.CACHE_DIR = theirs


@cache
def _cache_folder() -> str:
    package = Path(__file__).resolve().parent
    sources = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        content = file.read_bytes()
        if b"harness.kernel import" in content or file.name == "kernel.py":
            sources.update(content)
    name = f"kernels-{sources.hexdigest()[:16]}"
    beside = package / "__pycache__"
    writable = os.access(beside if beside.exists() else package, os.W_OK)
    return str(beside / name if writable else Path.home() / ".cache" / "harness" / name)
