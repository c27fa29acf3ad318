"""How every numerical kernel is compiled: once, kept on disk, one thread, nothing reordered.

Kernels over arrays (`kernel`, `inner`) are strict: each operation is rounded as it is written. An event loop (`loop`)
and its named steps (`step`) may fuse a product into a sum, and count no references to arrays.
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

# numba declares only some of its options.
_njit: Any = numba.njit


def kernel(function: Function) -> Function:
    """Compile a function over arrays, keeping its type for the checker."""
    with _own_cache():
        return cast(Function, numba.njit(cache=True, error_model="numpy")(function))


def inner(function: Function) -> Function:
    """A kernel that is written out where another calls it, for innermost loops.

    numba counts references to arrays at every real call, which made loops over neighbours four times slower.
    """
    return cast(Function, numba.njit(error_model="numpy", inline="always")(function))


# Where kernels, and the constants that are compiled into them, stand.
_ROOMS = ("broadphase", "measure", "methods", "motion", "narrowphase", "reference", "scene")

# What may be relaxed in an event loop. None of it reorders a sum: `contract` fuses a product into a sum, `arcp` and
# `nsz` concern divisions and the sign of zero.
_RELAXED = {"contract", "arcp", "nsz"}
# A step is never called from Python: without the wrappers for that it compiles in two thirds of the time. Without
# reference counts (`_nrt`), which a loop that makes no array does not need, it runs five times as fast.
_STEP: dict[str, Any] = {
    "forceinline": True,
    "_nrt": False,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "error_model": "numpy",
}


def loop(function: Function) -> Function:
    """Compile an event loop, which Python calls and which makes no array."""
    with _own_cache():
        return cast(Function, _njit(_nrt=False, cache=True, fastmath=_RELAXED, error_model="numpy")(function))


def step(function: Function) -> Function:
    """Compile a named step of an event loop; it is always inlined, so that a name costs nothing."""
    return cast(Function, _njit(fastmath=_RELAXED, **_STEP)(function))


def strict_step(function: Function) -> Function:
    """A step that gives the same bits wherever it is inlined: no product is fused into a sum."""
    return cast(Function, _njit(**_STEP)(function))


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
    for file in [Path(__file__), *(file for room in _ROOMS for file in sorted((package / room).rglob("*.py")))]:
        sources.update(file.read_bytes())
    name = f"kernels-{sources.hexdigest()[:16]}"
    beside = package / "__pycache__"
    writable = os.access(beside if beside.exists() else package, os.W_OK)
    return str(beside / name if writable else Path.home() / ".cache" / "harness" / name)
