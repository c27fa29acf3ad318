"""What may be relaxed in a kernel, and that a strict one stays strict whoever calls it first."""

import numpy as np

from harness.kernel import kernel, loop, step, strict_step


@step
def relaxed(a, b, c):
    return a * b + c


@strict_step
def strict(a, b, c):
    return a * b + c


@kernel
def called(a, b, c):
    return a * b + c


@step
def through_a_step(a, b, c):
    return strict(a, b, c)


@loop
def fly(numbers):
    a, b, c = numbers[0], numbers[1], numbers[2]
    numbers[3] = relaxed(a, b, c)
    numbers[4] = strict(a, b, c)
    numbers[5] = called(a, b, c)
    numbers[6] = through_a_step(a, b, c)


def test_a_strict_step_rounds_each_operation_in_a_relaxed_loop_too():
    """numba lets a function that does not say so take over what its first caller may relax."""
    tiny = 2.0**-30
    numbers = np.array([1.0 + tiny, 1.0 - tiny, -1.0, 9.0, 9.0, 9.0, 9.0])
    fly(numbers)
    assert numbers[3] in (0.0, -(tiny**2))  # as the processor can
    assert list(numbers[4:]) == [0.0, 0.0, 0.0]
