"""Candidates as the lanes of vectors: a row of memory each is read at once, and four rows become columns.

numba knows no vectors, so this one step is written for the compiler below it. Each operation is rounded as in the step
that it stands for.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

from harness.kernel import RELAXED
from harness.motion.predictive.state import CANDIDATE_OFFSETS, MOTION, Record, Records

FOUR = 4
_FLAGS = tuple(sorted(RELAXED))
_VECTOR = ir.VectorType(ir.DoubleType(), FOUR)
_BYTES = 8 * FOUR
_COLUMNS = ("gap_x", "gap_y", "gap_z", None, "velocity_x", "velocity_y", "velocity_z", "reach")


def _gather_four(context: Any, lanes: Any, m: Any, motions: Any, p0: Any, p1: Any, p2: Any, p3: Any, now: Any) -> Any:

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = ir.IntType(64)

        def integer(place: int) -> Any:
            return context.cast(builder, arguments[place], signature.args[place], types.intp)

        def at(base: Any, offset: Any) -> Any:
            return builder.bitcast(cast(Any, cgutils).pointer_add(builder, base, offset), _VECTOR.as_pointer())

        def read(base: Any, offset: int) -> Any:
            return builder.load(at(base, word(offset)), align=_BYTES)

        columns = builder.bitcast(arguments[0], ir.IntType(8).as_pointer())
        rows = cast(Any, make_array)(signature.args[2])(context, builder, arguments[2]).data
        own = CANDIDATE_OFFSETS["own"]
        own_place, own_motion = read(columns, own), read(columns, own + _BYTES)
        gaps, velocities = [], []
        for p in range(3, 3 + FOUR):
            row = cast(Any, cgutils).pointer_add(builder, rows, builder.mul(integer(p), word(MOTION.itemsize)))
            place, motion = read(row, 0), read(row, _BYTES)
            flown = _all_lanes(builder, builder.fsub(arguments[7], _lane(builder, place, 3), flags=_FLAGS))
            moved = builder.fadd(builder.fmul(motion, flown, flags=_FLAGS), place, flags=_FLAGS)
            gaps.append(builder.fsub(moved, own_place, flags=_FLAGS))
            velocities.append(builder.fsub(motion, own_motion, flags=_FLAGS))
        offset = builder.mul(integer(1), word(8))
        for name, column in zip(_COLUMNS, _transposed(builder, gaps) + _transposed(builder, velocities), strict=True):
            if name is not None:
                start = builder.add(offset, word(CANDIDATE_OFFSETS[name]))
                builder.store(column, at(columns, start), align=_BYTES)
        return context.get_dummy_value()

    return types.void(lanes, m, motions, p0, p1, p2, p3, now), generate


def _lane(builder: Any, vector: Any, which: int) -> Any:
    return builder.extract_element(vector, ir.IntType(32)(which))


def _all_lanes(builder: Any, number: Any) -> Any:
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), number, ir.IntType(32)(0))
    return _shuffled(builder, one, one, 0, 0, 0, 0)


def _shuffled(builder: Any, a: Any, b: Any, *lanes: int) -> Any:
    """Lanes of two vectors: 0 to 3 are those of the first."""
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(ir.IntType(32), FOUR), list(lanes)))


def _transposed(builder: Any, rows: Any) -> Any:
    """Four vectors of four as columns."""
    halves = [
        _shuffled(builder, rows[k], rows[k + 1], first, first + 4, first + 2, first + 6)
        for first in (0, 1)
        for k in (0, 2)
    ]
    return [_shuffled(builder, *halves[k : k + 2], *lanes) for lanes in ((0, 1, 4, 5), (2, 3, 6, 7)) for k in (0, 2)]


# Put spheres p0 to p3, at the time `now`, into the lanes from m on, as seen from `own` of the lanes.
gather_four = cast(Callable[[Record, int, Records, int, int, int, int, float], None], intrinsic(_gather_four))
