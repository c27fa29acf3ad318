"""Rosters: the few spheres of a neighbour list or of a cell, in two cache lines at most.

How many there are is at random, and so is where one of them stands: a loop over them ends in a mispredicted branch. A
roster is searched and copied as vectors instead, which renews a list in little more than half the time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from harness.kernel import instruction, step
from harness.motion.predictive.memory import LINE
from harness.motion.predictive.state import CAPACITY, Indices, Record

_NUMBERS = CAPACITY + 1  # in a roster: how many there are, and who
_BYTES = 4  # of each
# So many are copied at once. Few cells hold more.
FEW = 8


@step
def enlist(roster: Record, k: int) -> bool:
    """Append sphere k. Returns whether there was room."""
    if roster.count == CAPACITY:
        return False
    roster.who[roster.count] = k
    roster.count += 1
    return True


@step
def strike(roster: Record, k: int) -> None:
    """Take off sphere k, which stands there; the last one takes its place."""
    last = roster.count - 1
    roster.who[_place_of(roster, k)] = roster.who[last]
    roster.count = last


@step
def copy(roster: Record, found: Indices, n: int) -> int:
    """Append the spheres of a roster to a list of n. Returns its length; it needs room for `FEW` more."""
    _copy_few(roster, found, n)
    for m in range(FEW, roster.count):
        found[np.uintp(n + m)] = roster.who[m]
    return n + int(roster.count)


def _code_of_place_of(context: Any, roster: Any, k: Any) -> Any:
    from llvmlite import ir  # type: ignore[import-untyped]
    from numba import types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        number, word = ir.IntType(8 * _BYTES), ir.IntType(64)
        numbers = ir.VectorType(number, _NUMBERS)
        row = builder.load(builder.bitcast(arguments[0], ir.PointerType(numbers)), align=LINE)
        wanted = context.cast(builder, arguments[1], signature.args[1], types.uint32)
        nothing = ir.Constant(numbers, ir.Undefined)
        wanted = builder.insert_element(nothing, wanted, number(0))
        wanted = builder.shuffle_vector(wanted, nothing, ir.Constant(numbers, [0] * _NUMBERS))
        same = builder.bitcast(builder.icmp_unsigned("==", row, wanted), ir.IntType(_NUMBERS))
        same = builder.and_(same, same.type(-2))  # the first number is their count
        return builder.sub(builder.zext(builder.cttz(same, ir.IntType(1)(0)), word), word(1))

    return types.int64(roster, k), generate


# The first place of a roster with the number of sphere k.
_place_of = cast(Callable[[Record, int], int], instruction(_code_of_place_of))


def _code_of_copy_few(context: Any, roster: Any, found: Any, n: Any) -> Any:
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.np.arrayobj import make_array

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        few = ir.PointerType(ir.VectorType(ir.IntType(8 * _BYTES), FEW))
        n = context.cast(builder, arguments[2], signature.args[2], types.intp)
        found = cast(Any, make_array)(signature.args[1])(context, builder, arguments[1]).data
        roster = builder.bitcast(arguments[0], ir.PointerType(ir.IntType(8)))
        who = cast(Any, cgutils).pointer_add(builder, roster, _BYTES)
        row = builder.load(builder.bitcast(who, few), align=_BYTES)
        builder.store(row, builder.bitcast(builder.gep(found, [n]), few), align=_BYTES)
        return context.get_dummy_value()

    return types.void(roster, found, n), generate


# Copy the first FEW of a roster, or what stands there, to the places of a list from n on.
_copy_few = cast(Callable[[Record, Indices, int], None], instruction(_code_of_copy_few))
