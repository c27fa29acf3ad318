"""Several spheres compared at once are the same comparisons as one by one."""

import numpy as np

from harness.broadphase.lanes import LANES, lanes_touching, lanes_within, lowest_bit
from harness.broadphase.pairs import NEARLY
from harness.kernel import kernel


@kernel
def compiled(spheres, begin, point, square):
    return lanes_within(spheres, begin, point[0], point[1], point[2], square)


@kernel
def compiled_touching(spheres, begin, point, radius):
    return lanes_touching(spheres, begin, point[0], point[1], point[2], radius)


@kernel
def compiled_lowest_bit(bits):
    return lowest_bit(bits)


def test_each_bit_says_whether_that_sphere_is_near_to_the_last_digit():
    rng = np.random.default_rng(5)
    spheres = rng.normal(size=(3, 40))
    for begin in range(40 - LANES):
        point = rng.normal(size=3)
        gaps = point[:, None] - spheres[:, begin : begin + LANES]
        squares = gaps[0] * gaps[0] + gaps[1] * gaps[1] + gaps[2] * gaps[2]
        for square in (*squares, *np.nextafter(squares, 0), np.inf, np.nan):
            expected = sum(1 << lane for lane in range(LANES) if squares[lane] <= square)
            assert compiled(spheres, begin, point, square) == expected
            assert lanes_within(spheres, begin, *point, square) == expected


def test_each_bit_says_whether_that_sphere_may_touch_by_its_own_radius():
    rng = np.random.default_rng(6)
    spheres = rng.normal(size=(4, 40))
    spheres[3] = rng.uniform(0.01, 1.0, 40)
    for begin in range(40 - LANES):
        point, near = rng.normal(size=3), spheres[:, begin : begin + LANES]
        distances = np.sqrt(((point[:, None] - near[:3]) ** 2).sum(axis=0))
        for lane in range(LANES):  # its own radius so that it touches just, just not, and within rounding
            for factor, touches in ((1.0, True), (1 + 1e-15, True), (1 - 1e-15, True), (1 - 1e-5, False)):
                radius = distances[lane] * factor - near[3, lane]
                expected = sum(1 << k for k in range(LANES) if distances[k] ** 2 <= (radius + near[3, k]) ** 2 * NEARLY)
                assert compiled_touching(spheres, begin, point, radius) == expected
                assert lanes_touching(spheres, begin, *point, radius) == expected
                assert bool(expected >> lane & 1) == touches


def test_the_lowest_bit_is_found():
    for bits in (1, 6, 40, 1 << 62, (1 << 62) + (1 << 20)):
        expected = f"{bits:b}"[::-1].index("1")
        assert compiled_lowest_bit(bits) == lowest_bit(bits) == expected
