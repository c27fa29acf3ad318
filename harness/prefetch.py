"""A hint to the processor: read a cache line before it is needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from harness.kernel import instruction


def _prefetch(context: Any, array: Any, row: Any) -> Any:
    from llvmlite import ir  # type: ignore[import-untyped]
    from numba import types
    from numba.core import cgutils
    from numba.np.arrayobj import make_array

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = cast(Any, make_array)(signature.args[0])(context, builder, arguments[0])
        index = context.cast(builder, arguments[1], signature.args[1], types.intp)
        stride = builder.extract_value(data.strides, 0)
        pointer = cast(Any, cgutils).pointer_add(builder, data.data, builder.mul(index, stride))
        byte, word = ir.PointerType(ir.IntType(8)), ir.IntType(32)
        function = cast(Any, cgutils).get_or_insert_function(
            builder.module, ir.FunctionType(ir.VoidType(), [byte, word, word, word]), "llvm.prefetch.p0"
        )
        read, keep, data_cache = word(0), word(3), word(1)
        builder.call(function, [builder.bitcast(pointer, byte), read, keep, data_cache])
        return context.get_dummy_value()

    return types.void(array, row), generate


def _nothing(array: Any, row: int) -> None:
    """A hint may be left out."""


# Begin to read the cache line where a row of a C-contiguous array begins, without waiting for it.
prefetch = cast(Callable[[Any, int], None], instruction(_prefetch, _nothing))
