"""Double-double arithmetic: numbers in twice the digits of a float, as the sum of two.

After Dekker (1971) and Knuth; only what exact orientations need.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from harness.kernel import strict_step

DOUBLE_DOUBLE = np.dtype([("high", np.float64), ("low", np.float64)], align=True)

# 2 pi in twice the digits.
TURN, TURN_REST = 2.0 * pi, 2.4492935982947064e-16
# Splits a number of 53 bits into two of 26.
SPLIT = 134217729.0


@strict_step
def angle_after(rate: float, rate_rest: float, time: float, time_rest: float) -> float:
    """(rate + rest) (time + rest), less whole double turns, after which a quaternion comes back."""
    turns = np.rint(rate * time / (2.0 * TURN))
    angle, rest = two_product(rate, time)
    whole, whole_rest = two_product(turns, 2.0 * TURN)
    rest += rate * time_rest + rate_rest * time - whole_rest - turns * (2.0 * TURN_REST)
    # both are whole multiples of the same small unit and near each other, so that their difference is exact
    return float((angle - whole) + rest)


@strict_step
def norm(x: float, y: float, z: float) -> tuple[float, float]:
    """|(x, y, z)| in twice the digits."""
    high = sqrt(x * x + y * y + z * z)
    if high == 0.0:
        return 0.0, 0.0
    a, a_rest = two_product(x, x)
    b, b_rest = two_product(y, y)
    c, c_rest = two_product(z, z)
    d, d_rest = two_product(high, high)
    total, total_rest = two_sum(a, b)
    total, rest = two_sum(total, c)
    return high, ((total - d) + (rest + total_rest + a_rest + b_rest + c_rest - d_rest)) / (2.0 * high)


@strict_step
def two_sum(a: float, b: float) -> tuple[float, float]:
    """a + b, and its rounding error (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@strict_step
def two_product(a: float, b: float) -> tuple[float, float]:
    """a b, and its rounding error (Dekker)."""
    high = a * b
    p = SPLIT * a
    a1 = p - (p - a)
    p = SPLIT * b
    b1 = p - (p - b)
    a2, b2 = a - a1, b - b1
    return high, ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2
