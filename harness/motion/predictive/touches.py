"""Which of its candidates a sphere touches first, four of them at once.

The rows of four spheres are read into columns, their times are solved together, and the earliest of each column is
carried along in a register: no loop over a list of spheres makes LLVM write such code. Each operation is rounded as in
the other steps of the event loop, so that each time is that of `harness.narrowphase.spheres.time_to_touch`, to the bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from harness.kernel import RELAXED, instruction
from harness.motion.predictive.state import CANDIDATES, FOUR, MOTION, Indices, Record, Records
from harness.narrowphase.spheres import NOISE

_BYTES = 8 * FOUR  # of a vector: half a MOTION
_OFFSETS = {name: cast(Any, CANDIDATES.fields)[name][1] for name in ("due", "earliest", "tied")}


class _Vectors:
    """Operations on four doubles, as they are written into a compiled function."""

    def __init__(self, builder: Any) -> None:
        from llvmlite import ir  # type: ignore[import-untyped]

        self._ir, self._builder, self._flags = ir, builder, tuple(sorted(RELAXED))
        self.pair = ir.VectorType(ir.DoubleType(), 2)
        self.doubles, self.longs = ir.VectorType(ir.DoubleType(), FOUR), ir.VectorType(ir.IntType(64), FOUR)

    def constant(self, *values: float) -> Any:
        return self._ir.Constant(self.doubles, list(values) if len(values) == FOUR else [*values] * FOUR)

    def everywhere(self, kind: Any, value: Any) -> Any:
        """A number in all four places."""
        nothing = self._ir.Constant(kind, self._ir.Undefined)
        first = self._builder.insert_element(nothing, value, self._ir.IntType(32)(0))
        return self._shuffled(first, nothing, 0, 0, 0, 0)

    def plus(self, a: Any, b: Any) -> Any:
        return self._builder.fadd(a, b, flags=self._flags)

    def minus(self, a: Any, b: Any) -> Any:
        return self._builder.fsub(a, b, flags=self._flags)

    def times(self, a: Any, b: Any) -> Any:
        return self._builder.fmul(a, b, flags=self._flags)

    def over(self, a: Any, b: Any) -> Any:
        return self._builder.fdiv(a, b, flags=self._flags)

    def dot(self, a: list[Any], b: list[Any]) -> Any:
        first, second, third = (self.times(p, q) for p, q in zip(a, b, strict=True))
        return self.plus(self.plus(first, second), third)

    def cross(self, a: list[Any], b: list[Any]) -> list[Any]:
        return [self.minus(self.times(a[j], b[k]), self.times(a[k], b[j])) for j, k in ((1, 2), (2, 0), (0, 1))]

    def below(self, a: Any, b: Any) -> Any:
        return self._builder.fcmp_ordered("<", a, b)

    def positive(self, a: Any) -> Any:
        """The larger of each and zero."""
        zero = self.constant(0.0)
        return self._builder.select(self.below(zero, a), a, zero)

    def root(self, a: Any) -> Any:
        name, kind = f"llvm.sqrt.v{FOUR}f64", self._ir.FunctionType(self.doubles, [self.doubles])
        module = self._builder.module
        return self._builder.call(module.globals.get(name) or self._ir.Function(module, kind, name), [a])

    def columns(self, rows: list[list[Any]]) -> list[Any]:
        """The columns of four rows that are given by pairs.

        Pairs from two rows are read into one vector: that leaves half as many shuffles as reading half a row.
        """
        columns = []
        for first, second, third, fourth in zip(*rows, strict=True):
            even, odd = (self._shuffled(*both, 0, 1, 2, 3) for both in ((first, third), (second, fourth)))
            columns += [self._shuffled(even, odd, *places) for places in ((0, 4, 2, 6), (1, 5, 3, 7))]
        return columns

    def least(self, a: Any) -> Any:
        """The least of the four, in all places."""
        for places in ((2, 3, 0, 1), (1, 0, 3, 2)):
            other = self._shuffled(a, a, *places)
            a = self._builder.select(self.below(other, a), other, a)
        return a

    def bits(self, truths: Any) -> Any:
        """Four truths as a number of four bits."""
        return self._builder.bitcast(truths, self._ir.IntType(FOUR))

    def waits(self, gap: list[Any], velocity: list[Any], reach: Any) -> tuple[Any, Any]:
        """Whether spheres meet, and in how many seconds if they do: `time_to_touch`, which says why."""
        square_reach, zero = self.times(reach, reach), self.constant(0.0)
        approach, square, speed = self.dot(gap, velocity), self.dot(gap, gap), self.dot(velocity, velocity)
        distance = self.minus(square, square_reach)
        miss = self.cross(gap, velocity)
        quarter = self.minus(self.times(speed, square_reach), self.dot(miss, miss))
        noise = self.times(self.constant(NOISE), self.times(square, speed))
        builder = self._builder
        closing = builder.and_(self.below(approach, zero), self.below(noise, self.times(approach, approach)))
        reached = builder.or_(builder.fcmp_ordered(">=", quarter, zero), builder.fcmp_ordered("<=", distance, zero))
        wait = self.over(self.positive(distance), self.minus(self.root(self.positive(quarter)), approach))
        return builder.and_(closing, reached), wait

    def _shuffled(self, a: Any, b: Any, *places: int) -> Any:
        mask = self._ir.Constant(self._ir.VectorType(self._ir.IntType(32), FOUR), list(places))
        return self._builder.shuffle_vector(a, b, mask)


def _touch_first(
    context: Any, lanes: Any, motions: Any, k: Any, candidates: Any, start: Any, count: Any, now: Any
) -> Any:
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.np.arrayobj import make_array

    helpers, arrays = cast(Any, cgutils), cast(Any, make_array)
    word, short = ir.IntType(64), ir.IntType(32)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vectors = _Vectors(builder)
        doubles, longs = vectors.doubles, vectors.longs
        scratch = builder.bitcast(arguments[0], ir.PointerType(ir.IntType(8)))
        rows = arrays(signature.args[1])(context, builder, arguments[1]).data
        who = arrays(signature.args[3])(context, builder, arguments[3]).data
        k, start, count = (
            context.cast(builder, arguments[place], signature.args[place], types.intp) for place in (2, 4, 5)
        )
        now, last, never = arguments[6], builder.sub(count, word(1)), vectors.constant(float("inf"))

        def at(base: Any, offset: Any, kind: Any) -> Any:
            return builder.bitcast(helpers.pointer_add(builder, base, offset), ir.PointerType(kind))

        present = vectors.everywhere(doubles, now)

        def pairs(number: Any) -> list[Any]:
            """A sphere's x and y, z and own time, velocity along x and y, velocity along z and radius."""
            row = helpers.pointer_add(builder, rows, builder.mul(number, word(MOTION.itemsize)))
            return [builder.load(at(row, word(offset), vectors.pair), align=16) for offset in range(0, 64, 16)]

        def at_present(rows: list[list[Any]]) -> tuple[list[Any], list[Any], Any]:
            """Positions, velocities and radii of four spheres."""
            x, y, z, time, *velocity, radius = vectors.columns(rows)
            flown = vectors.minus(present, time)
            moved = [vectors.times(along, flown) for along in velocity]
            return [vectors.plus(*both) for both in zip(moved, (x, y, z), strict=True)], velocity, radius

        own_position, own_velocity, own_radius = at_present([pairs(k)] * FOUR)
        best = helpers.alloca_once_value(builder, never)
        which = helpers.alloca_once_value(builder, ir.Constant(longs, [0] * FOUR))
        ties = helpers.alloca_once_value(builder, ir.IntType(FOUR)(0))
        with helpers.for_range(builder, builder.udiv(builder.add(count, word(FOUR - 1)), word(FOUR))) as loop:
            m = builder.mul(loop.index, word(FOUR))
            read = []
            for column in range(FOUR):  # the last candidate fills the columns left over
                place = builder.add(m, word(column))
                place = builder.select(builder.icmp_signed("<", place, last), place, last)
                read.append(pairs(builder.zext(builder.load(builder.gep(who, [builder.add(start, place)])), word)))
            position, velocity, radius = at_present(read)
            gap = [vectors.minus(*both) for both in zip(position, own_position, strict=True)]
            velocity = [vectors.minus(*both) for both in zip(velocity, own_velocity, strict=True)]
            meet, wait = vectors.waits(gap, velocity, vectors.plus(radius, own_radius))
            here = builder.add(vectors.everywhere(longs, m), ir.Constant(longs, list(range(FOUR))))
            meet = builder.and_(meet, builder.icmp_signed("<", here, vectors.everywhere(longs, count)))
            due = builder.select(meet, vectors.plus(vectors.everywhere(doubles, now), wait), never)
            in_lane = builder.add(word(_OFFSETS["due"]), builder.mul(m, word(8)))
            builder.store(due, at(scratch, in_lane, doubles), align=_BYTES)
            before = builder.load(best)
            tied = builder.and_(meet, builder.fcmp_ordered("==", due, before))
            earlier = vectors.below(due, before)
            builder.store(builder.or_(builder.load(ties), vectors.bits(tied)), ties)
            builder.store(builder.select(earlier, due, before), best)
            builder.store(builder.select(earlier, here, builder.load(which)), which)
        least = vectors.least(builder.load(best))
        first = vectors.bits(builder.fcmp_ordered("==", builder.load(best), least))
        column = builder.zext(builder.cttz(first, ir.IntType(1)(0)), short)
        others = builder.and_(first, builder.sub(first, first.type(1)))
        tied = builder.zext(builder.or_(others, builder.load(ties)), word)
        builder.store(tied, at(scratch, word(_OFFSETS["tied"]), word))
        earliest = builder.extract_element(least, short(0))
        builder.store(earliest, at(scratch, word(_OFFSETS["earliest"]), earliest.type))
        return builder.extract_element(builder.load(which), column)

    return types.int64(lanes, motions, k, candidates, start, count, now), generate


# Solve for when sphere k touches `count` candidates, at most LANES, which stand in their list from the place `start`
# on, after the time `now`. The times go into the lanes, with the earliest, and whether any two may be the same.
# Returns the lane of the earliest.
touch_first = cast(
    Callable[[Record, Records, int, Indices, int, int, float], int],
    instruction(_touch_first),
)
