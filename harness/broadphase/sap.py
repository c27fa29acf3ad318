"""Sweep and prune: which bodies are close enough to touch, by the intervals that they cover along the axes.

Two bodies touch only if their intervals overlap along all three axes. The bodies stand in a list, in the order of their
lower ends along one axis, and each is compared with those after it, up to the first that begins beyond its upper end.
So every pair that overlaps along this axis is met exactly once, whatever the sizes: how far a body looks depends on its
own size alone, and a few large bodies among many small ones need no list of their own.

The order is kept from frame to frame and restored by insertion sort, as few bodies change places in a frame (Baraff,
"Dynamic Simulation of Non-Penetrating Rigid Bodies", 1992). I-COLLIDE (Cohen, Lin, Manocha and Ponamgi, 1995) keeps a
list for each axis and records every change of places. Here one axis is swept, the one with the fewest overlaps, and the
pairs met are compared along the other two, so that no pair has to be remembered.

The work does not grow linearly, as a grid's does: of n bodies spread evenly through a cube, each overlaps about n^(2/3)
others along an axis, so that n^(5/3) pairs are tested.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.arrays import Floats, Pairs
from harness.broadphase.levels import span
from harness.broadphase.pairs import (
    NEARLY,
    SMALLEST,
    Keys,
    checked_positions,
    checked_radii,
    require_finite,
    touching,
    unpack,
)
from harness.broadphase.scheme import Scheme
from harness.kernel import inner, kernel
from harness.scene.box import Box

Order = NDArray[np.int32]
Blocks = NDArray[np.void]
Block = Any  # one record of Blocks, whose fields mypy does not know

LANES = 32
"""Bodies of a block, which are compared at once. With 64 a frame of 1e4 bodies takes a quarter longer; with 16 the
comparison is no longer vectorised, and a frame takes two to five times as long."""

BLOCK = np.dtype(
    [
        ("low_second", np.int16, LANES),  # where each body's interval begins along the second axis, in steps
        ("high_second", np.int16, LANES),  # where it ends
        ("low_third", np.int16, LANES),  # and along the third axis
        ("high_third", np.int16, LANES),
    ]
)

LAST_STEP = 2**15 - 1
"""Steps along the second and third axis, counted from 0. In 16 bits twice as many ends fit into a register as in 32,
with which a frame of 1e5 bodies takes 30 % longer."""

SLACK = 2.0**-49
"""Relative surplus of an interval: more than rounding can do to its ends and to the test of two spheres."""

MOST_MOVES = 4
"""Places that insertion sort may move a body, on average, before a full sort is quicker. Bodies that fly a sixtieth of
their size in a frame move half a place among 1e3 of them, 2 among 1e4, 10 among 1e5 (packing .3)."""


class SweepAndPrune:
    """One list of bodies, sorted and swept along one axis every frame. See `BroadPhase`.

    Sorting and sweeping are bookkeeping. All pairs that the sweep meets are put to a test, of their intervals along the
    two other axes and then of their spheres, and so all of them count in `pair_tests`.

    Parameters
    ----------
    radii : (n,) array, m
    box : Box
        Where the bodies are expected. Those outside are found all the same, if many of them more slowly.

    Attributes
    ----------
    full_sorts : int
        Frames so far in which bodies had moved so much that the order of the frame before was of no use.

    Examples
    --------
    >>> scheme = SweepAndPrune([0.5, 0.5, 0.5], Box(np.ones(3)))
    >>> scheme.close_pairs([[0, 0, 0], [0.9, 0, 0], [0, 1.1, 0]])
    array([[0, 1]])
    """

    def __init__(self, radii: ArrayLike, box: Box) -> None:
        self.radii = checked_radii(radii)
        self.pair_tests = 0
        self.full_sorts = 0
        count = len(self.radii)
        self._half = np.array(box.half, np.float64)
        self._axis = 0
        self._tests = 0  # in the last frame
        self._most_tests = -1  # beyond which the axis is chosen anew
        self._order = np.arange(count, dtype=np.int32)
        self._lows = np.empty(count)
        self._spheres = np.empty((count, 4))
        self._blocks = np.zeros(count // LANES + 1, BLOCK)
        self._keys = np.empty(count + 1, np.int64)

    def close_pairs(self, positions: ArrayLike) -> Pairs:
        """Pairs of bodies whose bounding spheres touch, as `BroadPhase.close_pairs` defines them."""
        positions = checked_positions(positions, len(self.radii))
        require_finite(positions)
        self._sort(positions)
        place(positions, self.radii, self._half, self._axis, self._order, self._spheres, self._blocks)
        swept = self._axis, self._order, self._lows, self._spheres, self._blocks
        found, self._tests = sweep(*swept, self._keys)
        if found > len(self._keys):  # count first, then make room: rare, as the room is kept
            self._keys = np.empty(found + found // 2, np.int64)
            sweep(*swept, self._keys)
        self.pair_tests += self._tests
        keys = self._keys[:found]
        keys.sort()
        return unpack(keys)

    def _sort(self, positions: Floats) -> None:
        """Put the bodies in order, along another axis if twice as many overlap as did when this one was chosen."""
        if self._tests > self._most_tests:
            overlaps = [count_overlaps(positions, self.radii, axis) for axis in range(3)]
            self._axis = int(np.argmin(overlaps))
            self._most_tests = 2 * overlaps[self._axis] + len(self.radii)
        if not insertion_sort(positions, self.radii, self._axis, self._order, self._lows):
            self.full_sorts += 1
            lows, _ = ends(positions, self.radii, self._axis)
            self._order[:] = np.argsort(lows)
            insertion_sort(positions, self.radii, self._axis, self._order, self._lows)


def count_overlaps(positions: Floats, radii: Floats, axis: int) -> int:
    """How many pairs of bodies overlap along an axis: those that a sweep along it would meet."""
    lows, highs = ends(positions, radii, axis)
    begun = np.searchsorted(np.sort(lows), highs, side="right")  # the body itself and all before it included
    return int(begun.sum()) - len(radii) * (len(radii) + 1) // 2


@kernel
def ends(positions: Floats, radii: Floats, axis: int) -> tuple[Floats, Floats]:
    """Lower and upper ends, m, of all bodies along an axis."""
    lows, highs = np.empty(len(radii)), np.empty(len(radii))
    for i in range(len(radii)):
        lows[i] = lower_end(positions[i, axis], radii[i])
        highs[i] = upper_end(positions[i, axis], radii[i])
    return lows, highs


@inner
def lower_end(x: float, radius: float) -> float:
    """Where the interval of a body begins, m. No body that ends before it can touch, to the last bit."""
    return x - (radius + SLACK * (abs(x) + radius))


@inner
def upper_end(x: float, radius: float) -> float:
    """Where the interval of a body ends, m."""
    return x + (radius + SLACK * (abs(x) + radius))


@kernel
def insertion_sort(positions: Floats, radii: Floats, axis: int, order: Order, lows: Floats) -> bool:
    """Insertion sort by lower ends, from the order of the last frame.

    Parameters
    ----------
    positions : (n, 3), m
    radii : (n,), m
    axis : 0, 1 or 2
    order : (n,) the bodies; rewritten
    lows : (n,) written: their lower ends along the axis, m

    Returns
    -------
    Whether they are in order now. If they have moved too much to be worth it, what is written is of no use, except
    that `order` still holds every body once.
    """
    moves = 0
    for slot in range(len(order)):
        body = order[slot]
        low = lower_end(positions[body, axis], radii[body])
        hole = slot
        while hole > 0 and lows[hole - 1] > low:
            lows[hole], order[hole] = lows[hole - 1], order[hole - 1]
            hole -= 1
        lows[hole], order[hole] = low, body
        moves += slot - hole
        if moves > MOST_MOVES * (slot + 64):  # 64: a few bodies at the start may have moved more than most
            return False
    return True


@kernel
def place(
    positions: Floats, radii: Floats, half: Floats, axis: int, order: Order, spheres: Floats, blocks: Blocks
) -> None:
    """Lay out the bodies in their order: x, y, z and radius, m, and the intervals along the two other axes."""
    second, third = (axis + 1) % 3, (axis + 2) % 3
    low_second, length_second = span(positions[:, second], half[second])
    low_third, length_third = span(positions[:, third], half[third])
    scale_second, scale_third = LAST_STEP / (length_second + SMALLEST), LAST_STEP / (length_third + SMALLEST)
    for slot in range(len(order)):
        body = order[slot]
        for k in range(3):
            spheres[slot, k] = positions[body, k]
        radius = radii[body]
        spheres[slot, 3] = radius
        block, lane = blocks[slot // LANES], slot % LANES
        y, z = positions[body, second], positions[body, third]
        block.low_second[lane] = step(lower_end(y, radius), low_second, scale_second)
        block.high_second[lane] = step(upper_end(y, radius), low_second, scale_second)
        block.low_third[lane] = step(lower_end(z, radius), low_third, scale_third)
        block.high_third[lane] = step(upper_end(z, radius), low_third, scale_third)


@inner
def step(x: float, low: float, scale: float) -> int:
    """Round an end, m, to a step. It never decreases with x, so that ends which overlap still do as steps."""
    return int(min(max((x - low) * scale, 0.0), LAST_STEP))


@kernel
def sweep(axis: int, order: Order, lows: Floats, spheres: Floats, blocks: Blocks, keys: Keys) -> tuple[int, int]:
    """Compare each body with those that begin within its interval, a block of them at a time.

    Parameters
    ----------
    axis : 0, 1 or 2
    order : (n,) the bodies in the order of their lower ends along the axis
    lows : (n,) those ends, m
    spheres, blocks : (n, 4), (n // LANES + 1,) what `place` has written
    keys : (capacity,) written: i << 32 | j of each close pair, in no order, as far as there is room

    Returns
    -------
    How many pairs are close, and how many were tested.
    """
    found, tests = 0, 0
    for slot in range(len(order)):
        high = upper_end(spheres[slot, axis], spheres[slot, 3])
        begin = slot + 1
        while begin < len(order) and lows[begin] <= high:
            block = begin // LANES
            end = min((block + 1) * LANES, len(order))
            while lows[end - 1] > high:
                end -= 1
            tests += end - begin
            if overlaps_any(blocks[slot // LANES], slot % LANES, blocks[block]):
                found = compare(slot, begin, end, order, spheres, keys, found)
            begin = end
    return found, tests


@inner
def overlaps_any(own: Block, lane: int, others: Block) -> bool:
    """Whether a body, in a lane of its own block, overlaps any body of another block along both other axes."""
    low_second, high_second = own.low_second[lane], own.high_second[lane]
    low_third, high_third = own.low_third[lane], own.high_third[lane]
    overlap = False
    for k in range(LANES):  # without a branch, or it is not vectorised
        overlap |= (
            (others.low_second[k] <= high_second)
            & (others.high_second[k] >= low_second)
            & (others.low_third[k] <= high_third)
            & (others.high_third[k] >= low_third)
        )
    return overlap


@inner
def compare(slot: int, begin: int, end: int, order: Order, spheres: Floats, keys: Keys, found: int) -> int:
    """Put the body in a slot to the test with a run of others. Returns how many close pairs are found by now."""
    x, y, z, radius = spheres[slot, 0], spheres[slot, 1], spheres[slot, 2], spheres[slot, 3]
    for other in range(begin, end):
        dx, dy, dz = x - spheres[other, 0], y - spheres[other, 1], z - spheres[other, 2]
        reach = radius + spheres[other, 3]
        # Most are far apart, and a root takes longer than all the rest of the test.
        if dx * dx + dy * dy + dz * dz <= NEARLY * reach * reach and touching(dx, dy, dz, reach):
            if found < len(keys):
                i, j = order[slot], order[other]
                keys[found] = min(i, j) << 32 | max(i, j)
            found += 1
    return found


SCHEME = Scheme("sweep and prune along one axis", lambda radii, box, size_classes: SweepAndPrune(radii, box))
