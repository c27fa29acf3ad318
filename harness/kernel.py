"""How every numerical kernel is compiled: once, kept on disk, one thread, nothing reordered.

Kernels over arrays (`kernel`, `inner`) are strict: each operation is rounded as it is written. An event loop (`loop`)
and its named steps (`step`) may fuse a product into a sum, and count no references to arrays.

numba is imported with the first call of a kernel, and what the decorators return becomes numba's then: a command that
flies nothing, such as `harness plan`, need not wait for it.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cache, update_wrapper
from threading import RLock
from typing import Any, TypeVar, cast

from harness.kernel_cache import forgiving, own_cache

Function = TypeVar("Function", bound=Callable[..., Any])


# Said wherever nothing may be relaxed: numba has what does not say so take over what its first caller may relax.
STRICT: dict[str, Any] = {"fastmath": False}


def kernel(function: Function) -> Function:
    """Compile a function over arrays, keeping its type for the checker. Other threads run while it does."""
    options: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "nogil": True, **STRICT}
    return cast(Function, _Waiting(function, lambda: _kept(function, **options)))


def inner(function: Function) -> Function:
    """A kernel that is written out where another calls it, for innermost loops.

    numba counts references to arrays at every real call, which made loops over neighbours four times slower.
    """
    return cast(Function, _Waiting(function, lambda: _njit(error_model="numpy", inline="always", **STRICT)(function)))


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
    options: dict[str, Any] = {"_nrt": False, "fastmath": RELAXED, "error_model": "numpy", "no_cfunc_wrapper": True}
    return cast(Function, _Waiting(function, lambda: _kept(function, **options)))


def step(function: Function) -> Function:
    """Compile a named step of an event loop; it is always inlined, so that a name costs nothing."""
    return cast(Function, _Waiting(function, lambda: _widened(_njit(fastmath=RELAXED, **_STEP)(function))))


def strict_step(function: Function) -> Function:
    """A step that gives the same bits wherever it is inlined: no product is fused into a sum.

    Like every step it counts no references: it may read and write arrays that it is given, and makes and returns none.
    """
    return cast(Function, _Waiting(function, lambda: _widened(_njit(**STRICT, **_STEP)(function))))


def instruction(code: Callable[..., Any], plain: Callable[..., Any] | None = None) -> Any:
    """What a kernel may call where numba has no function for an instruction of the machine.

    Parameters
    ----------
    code : takes a typing context and the types of the arguments, gives a signature and what generates the instruction,
        as `numba.extending.intrinsic` asks
    plain : what stands for it where numba is told not to compile
    """

    def made() -> Any:
        from numba.extending import intrinsic

        return intrinsic(code) if plain is None or compiles() else plain

    return _Waiting(code, made)


def written_as(compiled: Callable[..., Any]) -> Callable[[Function], Function]:
    """Give a function another body in kernels than in Python.

    Parameters
    ----------
    compiled : takes the types of the arguments and gives the function to write out, as `numba.extending.overload` asks

    Notes
    -----
    Nobody may call it who writes to an array in a tuple: numba takes such a write for dead code once it has written a
    function out in this way, and drops it. Hence `first_or_call`.
    """

    def named(function: Function) -> Function:
        def made() -> Any:
            from numba.extending import overload

            overload(function, inline="always", strict=False)(compiled)
            return function

        return cast(Function, _Waiting(function, made))

    return named


def first_or_call(context: Any, body: Callable[..., Any] | None, *kinds: Any) -> Any:
    """What an `instruction` gives that calls a function, or is its first argument as it stands.

    So a kernel can do one thing or another by the types of what it is given. References to arrays are counted as the
    caller counts them: it may be called in a loop or a step too.

    Parameters
    ----------
    context : numba's, of types
    body : the function to call; None for the first argument
    kinds : the types of the arguments
    """
    from numba.core import types
    from numba.core.imputils import impl_ret_borrowed

    if body is None:
        borrowed: Any = impl_ret_borrowed
        return kinds[0](*kinds), lambda context, builder, signature, arguments: borrowed(
            context, builder, signature.return_type, arguments[0]
        )
    dispatched: Any = types.Dispatcher(_to_be_typed(body))
    signature = context.resolve_function_type(dispatched, kinds, {})
    return signature, lambda context, builder, signature, arguments: context.compile_internal(
        builder, body, signature, arguments
    )


@cache
def _to_be_typed(body: Callable[..., Any]) -> Any:
    """A function as numba types it; kept, because numba's own types do not keep it."""
    return _njit(error_model="numpy", **STRICT)(body)


_lock = RLock()


class _Waiting:
    """A kernel that numba does not know yet; called or asked for anything else, it becomes one.

    numba looks at the globals of a kernel for those that it calls. So with a kernel all that are in its module become
    numba's, and all in the modules that those are from.
    """

    def __init__(self, function: Callable[..., Any], make: Callable[[], Any]) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._make = make
        self._made: Any = None

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return (self._made or self.made())(*arguments, **named)

    def __getattr__(self, name: str) -> Any:
        """What numba's own has, its type among it."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.made(), name)

    def made(self) -> Any:
        """What numba made of it."""
        with _lock:
            if self._made is None:
                self._made = self._make()
                _make_all(self.py_func.__globals__)
                for cell in self.py_func.__closure__ or ():
                    if isinstance(cell.cell_contents, _Waiting):
                        cell.cell_contents = cell.cell_contents.made()
        return self._made


def _make_all(names: dict[str, Any]) -> None:
    """Put numba's kernels in the place of those of a module that wait."""
    for name, value in list(names.items()):
        if isinstance(value, _Waiting):
            names[name] = value.made()


def compiles() -> bool:
    """Whether numba compiles, and is not told by NUMBA_DISABLE_JIT to let Python do all, as far as that can."""
    import numba

    return not getattr(numba.config, "DISABLE_JIT", False)


def _njit(**options: Any) -> Any:
    import numba

    njit: Any = numba.njit  # numba declares only some of its options and functions
    return njit(**options)


def _kept(function: Any, **options: Any) -> Any:
    """Compile, or load what was compiled before; nothing of either where numba is told not to compile."""

    if not compiles():
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
    from numba.core import types as numba_types

    types: Any = numba_types
    if isinstance(kind, types.BaseNamedTuple):
        return types.BaseTuple.from_types(tuple(map(_without_literals, kind.types)), kind.instance_class)
    return types.unliteral(kind)
