"""Candidates as the lanes of vectors: a row of memory is read at once, and the rows of four spheres become columns.

LLVM makes such code of no loop over a list of spheres. Each operation is rounded as in the other steps of the loop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from harness.kernel import RELAXED, instruction
from harness.motion.predictive.state import CANDIDATE_OFFSETS, MOTION, Record, Records

FOUR = 4
_BYTES = 8 * FOUR  # of a vector: half a MOTION
_FLAGS = tuple(sorted(RELAXED))
_COLUMNS = ("gap_x", "gap_y", "gap_z", None, "velocity_x", "velocity_y", "velocity_z", "reach")


def _gather_four(context: Any, lanes: Any, m: Any, motions: Any, p0: Any, p1: Any, p2: Any, p3: Any, now: Any) -> Any:
    from llvmlite import ir  # type: ignore[import-untyped]
    from numba import types
    from numba.core import cgutils
    from numba.np.arrayobj import make_array

    vector, word, byte = ir.VectorType(ir.DoubleType(), FOUR), ir.IntType(64), ir.IntType(8)
    pointer_add: Any = cgutils.pointer_add

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        def integer(place: int) -> Any:
            return context.cast(builder, arguments[place], signature.args[place], types.intp)

        def at(base: Any, offset: Any) -> Any:
            return builder.bitcast(pointer_add(builder, base, offset), ir.PointerType(vector))

        def read(base: Any, offset: int) -> Any:
            return builder.load(at(base, word(offset)), align=_BYTES)

        def shuffled(a: Any, b: Any, *places: int) -> Any:
            return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(ir.IntType(32), FOUR), list(places)))

        def transposed(rows: list[Any]) -> list[Any]:
            even = [shuffled(rows[k], rows[k + 1], 0, 4, 2, 6) for k in (0, 2)]
            odd = [shuffled(rows[k], rows[k + 1], 1, 5, 3, 7) for k in (0, 2)]
            return [shuffled(*pair, *places) for places in ((0, 1, 4, 5), (2, 3, 6, 7)) for pair in (even, odd)]

        columns = builder.bitcast(arguments[0], ir.PointerType(byte))
        rows = cast(Any, make_array)(signature.args[2])(context, builder, arguments[2]).data
        own_place = read(columns, CANDIDATE_OFFSETS["own"])
        own_motion = read(columns, CANDIDATE_OFFSETS["own"] + _BYTES)
        nothing = ir.Constant(vector, ir.Undefined)
        gaps, velocities = [], []
        for p in range(3, 3 + FOUR):
            row = pointer_add(builder, rows, builder.mul(integer(p), word(MOTION.itemsize)))
            place, motion = read(row, 0), read(row, _BYTES)
            time = builder.extract_element(place, ir.IntType(32)(3))
            flown = builder.fsub(arguments[7], time, flags=_FLAGS)
            flown = shuffled(builder.insert_element(nothing, flown, ir.IntType(32)(0)), nothing, 0, 0, 0, 0)
            moved = builder.fadd(builder.fmul(motion, flown, flags=_FLAGS), place, flags=_FLAGS)
            gaps.append(builder.fsub(moved, own_place, flags=_FLAGS))
            velocities.append(builder.fsub(motion, own_motion, flags=_FLAGS))
        lane = builder.mul(integer(1), word(8))
        for name, column in zip(_COLUMNS, transposed(gaps) + transposed(velocities), strict=True):
            if name is not None:
                offset = builder.add(lane, word(CANDIDATE_OFFSETS[name]))
                builder.store(column, at(columns, offset), align=_BYTES)
        return context.get_dummy_value()

    return types.void(lanes, m, motions, p0, p1, p2, p3, now), generate


# Put spheres p0 to p3, moved to the time `now`, into the lanes from m on, as seen from the `own` of the lanes.
gather_four = cast(Callable[[Record, int, Records, int, int, int, int, float], None], instruction(_gather_four))
