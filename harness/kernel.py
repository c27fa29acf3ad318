"""How every numerical kernel is compiled: once, kept on disk, one thread, nothing reordered.

Kernels over arrays (`kernel`, `inner`) are strict: each operation is rounded as it is written. An event loop (`loop`)
and its named steps (`step`) may fuse a product into a sum, and count no references to arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar, cast

import numba
from numba.core import types as numba_types

from harness.kernel_cache import forgiving, own_cache

Function = TypeVar("Function", bound=Callable[..., Any])

# numba declares only some of its options and functions.
_njit: Any = numba.njit
_types: Any = numba_types


def kernel(function: Function) -> Function:
    """Compile a function over arrays, keeping its type for the checker."""
    return cast(Function, _kept(function, error_model="numpy", no_cfunc_wrapper=True))


def inner(function: Function) -> Function:
    """A kernel that is written out where another calls it, for innermost loops.

    numba counts references to arrays at every real call, which made loops over neighbours four times slower.
    """
    return cast(Function, numba.njit(error_model="numpy", inline="always")(function))


# What may be relaxed in an event loop. None of it reorders a sum: `contract` fuses a product into a sum, `arcp` and
# `nsz` concern divisions and the sign of zero.
RELAXED = {"contract", "arcp", "nsz"}
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
    return cast(Function, _kept(function, _nrt=False, fastmath=RELAXED, error_model="numpy", no_cfunc_wrapper=True))


def step(function: Function) -> Function:
    """Compile a named step of an event loop; it is always inlined, so that a name costs nothing."""
    return cast(Function, _widened(_njit(fastmath=RELAXED, **_STEP)(function)))


def strict_step(function: Function) -> Function:
    """A step that gives the same bits wherever it is inlined: no product is fused into a sum.

    Like every step it counts no references: it may read and write arrays that it is given, and makes and returns none.
    """
    return cast(Function, _widened(_njit(**_STEP)(function)))


def _kept(function: Any, **options: Any) -> Any:
    """Compile, or load what was compiled before; nothing of either where numba is told not to compile."""
    if getattr(numba.config, "DISABLE_JIT", False):
        return function
    with own_cache(function.__module__) as folder, suppress(RuntimeError):  # of numba, where no folder takes files
        made = _njit(cache=bool(folder), **options)(function)
        # where ours takes none, as on a full disk, numba turns to one that old code of ours may stand in
        if not folder or made._cache.cache_path.startswith(folder):
            return _widened(forgiving(made))
    return _widened(_njit(**options)(function))


def _widened(dispatcher: Any) -> Any:
    """Compile for the type of an integer that a caller has written out, not for this one integer.

    numba itself compiles a function anew for each, and once more for variables.
    """
    template = getattr(dispatcher, "get_call_template", None)
    if template is not None:  # else numba is told not to compile
        dispatcher.get_call_template = lambda positional, named: template(
            tuple(map(_without_literals, positional)), {name: _without_literals(kind) for name, kind in named.items()}
        )
    return dispatcher


def _without_literals(kind: Any) -> Any:
    if isinstance(kind, _types.BaseNamedTuple):
        return _types.BaseTuple.from_types(tuple(map(_without_literals, kind.types)), kind.instance_class)
    return _types.unliteral(kind)
