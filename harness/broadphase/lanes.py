"""Several spheres compared at once: one vector instruction for all of them.

Runs of neighbours are short, and LLVM makes vector instructions of long loops only. Written as vectors, the comparisons
of a frame of equal spheres take a third to a half of the time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from harness.arrays import Floats
from harness.broadphase.pairs import NEARLY
from harness.kernel import instruction, written_as

LANES = 4
"""Spheres compared at once. At packing .3 three cells in a row hold 1.7 spheres, and seldom more than four."""


def _lanes_within(context: Any, spheres: Any, begin: Any, x: Any, y: Any, z: Any, square: Any) -> Any:
    return _comparison(spheres, begin, lambda vectors, builder, loaded, given: given)


def _lanes_touching(context: Any, spheres: Any, begin: Any, x: Any, y: Any, z: Any, radius: Any) -> Any:
    def largest(vectors: Any, builder: Any, loaded: Any, given: Any) -> Any:
        reach = builder.fadd(given, loaded(3))
        return builder.fmul(builder.fmul(reach, reach), vectors([vectors.element(NEARLY)] * LANES))

    return _comparison(spheres, begin, largest)


def _comparison(spheres: Any, begin: Any, largest: Any) -> Any:
    """The instructions that compare squares of distances; `largest` generates those that the distances may have."""
    from llvmlite import ir  # type: ignore[import-untyped]
    from numba import types
    from numba.core import cgutils
    from numba.np.arrayobj import make_array

    doubles, indices = ir.VectorType(ir.DoubleType(), LANES), ir.VectorType(ir.IntType(32), LANES)

    def in_all_lanes(builder: Any, value: Any) -> Any:
        nothing = ir.Constant(doubles, ir.Undefined)
        one = builder.insert_element(nothing, value, ir.IntType(32)(0))
        return builder.shuffle_vector(one, nothing, ir.Constant(indices, [0] * LANES))

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = cast(Any, make_array)(signature.args[0])(context, builder, arguments[0])
        first = context.cast(builder, arguments[1], signature.args[1], types.intp)
        row = builder.extract_value(array.strides, 0)

        def loaded(column: int) -> Any:
            data = cast(Any, cgutils).pointer_add(builder, array.data, builder.mul(row, row.type(column)))
            lanes = builder.load(builder.bitcast(builder.gep(data, [first]), ir.PointerType(doubles)))
            lanes.align = 8
            return lanes

        total = None
        for axis in range(3):
            gap = builder.fsub(in_all_lanes(builder, arguments[2 + axis]), loaded(axis))
            product = builder.fmul(gap, gap)
            total = product if total is None else builder.fadd(total, product)
        near = builder.fcmp_ordered("<=", total, largest(doubles, builder, loaded, in_all_lanes(builder, arguments[5])))
        return builder.zext(builder.bitcast(near, ir.IntType(LANES)), ir.IntType(64))

    number = types.float64
    return types.int64(spheres, begin, number, number, number, number), generate


def _lowest_bit(context: Any, bits: Any) -> Any:
    from llvmlite import ir
    from numba import types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        not_zero = ir.IntType(1)(1)
        return builder.cttz(arguments[0], not_zero)

    return types.int64(types.int64), generate


_vector_lanes_within = cast(Callable[..., int], instruction(_lanes_within))
_vector_lanes_touching = cast(Callable[..., int], instruction(_lanes_touching))
_machine_lowest_bit = cast(Callable[[int], int], instruction(_lowest_bit))


def _compiled_lanes_within(spheres: Any, begin: Any, x: Any, y: Any, z: Any, square: Any) -> Any:
    return lambda spheres, begin, x, y, z, square: _vector_lanes_within(spheres, begin, x, y, z, square)


def _compiled_lanes_touching(spheres: Any, begin: Any, x: Any, y: Any, z: Any, radius: Any) -> Any:
    return lambda spheres, begin, x, y, z, radius: _vector_lanes_touching(spheres, begin, x, y, z, radius)


def _compiled_lowest_bit(bits: Any) -> Any:
    return lambda bits: _machine_lowest_bit(bits)


@written_as(_compiled_lanes_within)
def lanes_within(spheres: Floats, begin: int, x: float, y: float, z: float, square: float) -> int:
    """Which of the next spheres have their centres within a distance of a point.

    Parameters
    ----------
    spheres : (3, n) x, y and z of centres, m
    begin : of the first of `LANES` spheres
    x, y, z : the point, m
    square : of the distance, m^2

    Returns
    -------
    Bit k is set if |x_(begin + k) - point|^2 <= square.
    """
    near = 0
    for lane in range(LANES):
        dx, dy, dz = (c - spheres[axis, begin + lane] for axis, c in enumerate((x, y, z)))
        near |= int(dx * dx + dy * dy + dz * dz <= square) << lane
    return near


@written_as(_compiled_lanes_touching)
def lanes_touching(spheres: Floats, begin: int, x: float, y: float, z: float, radius: float) -> int:
    """Which of the next spheres may touch a sphere: all that do, and none that is a millionth farther away.

    Parameters
    ----------
    spheres : (4, n) x, y and z of centres and radii, m
    begin : of the first of `LANES` spheres
    x, y, z, radius : of the sphere, m

    Returns
    -------
    Bit k is set if |x_(begin + k) - point|^2 <= `NEARLY` (r_(begin + k) + radius)^2.
    """
    near = 0
    for lane in range(LANES):
        dx, dy, dz = (c - spheres[axis, begin + lane] for axis, c in enumerate((x, y, z)))
        reach = radius + spheres[3, begin + lane]
        near |= int(dx * dx + dy * dy + dz * dz <= reach * reach * NEARLY) << lane
    return near


@written_as(_compiled_lowest_bit)
def lowest_bit(bits: int) -> int:
    """The place of the lowest bit that is set, of at least one."""
    return (bits & -bits).bit_length() - 1
