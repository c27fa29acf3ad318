"""What the vectors of the event loop say of candidates, against the plain formula."""

from __future__ import annotations

import numpy as np
import pytest

from harness.kernel import loop
from harness.motion.predictive.memory import aligned
from harness.motion.predictive.state import CANDIDATES, LANES, MOTION
from harness.motion.predictive.touches import touch_first
from harness.narrowphase.spheres import time_to_touch


@loop
def by_vectors(lanes, motions, k, candidates, start, count, now):
    return touch_first(lanes[0], motions, k, candidates, start, count, now)


@loop
def by_formula(motions, k, p, now):
    a, b = motions[k], motions[p]
    flown_a, flown_b = now - a.time, now - b.time
    gap = (
        (b.position[0] + b.velocity[0] * flown_b) - (a.position[0] + a.velocity[0] * flown_a),
        (b.position[1] + b.velocity[1] * flown_b) - (a.position[1] + a.velocity[1] * flown_a),
        (b.position[2] + b.velocity[2] * flown_b) - (a.position[2] + a.velocity[2] * flown_a),
    )
    velocity = (b.velocity[0] - a.velocity[0], b.velocity[1] - a.velocity[1], b.velocity[2] - a.velocity[2])
    return now + time_to_touch(gap, velocity, a.radius + b.radius)


def spheres(rng, count, whole):
    """Motions at random; of whole numbers, so that many touches are at one time."""
    motions = aligned(count, MOTION)
    draw = (lambda *size: rng.integers(-1, 2, size).astype(float)) if whole else lambda *size: rng.normal(size=size)
    motions["position"] = 3.0 * draw(count, 3)
    motions["velocity"] = draw(count, 3)
    motions["time"] = 0.0 if whole else rng.uniform(0.0, 1.0, count)
    motions["radius"] = 1.0 if whole else rng.uniform(0.1, 1.0, count)
    return motions


@pytest.mark.parametrize("whole", [False, True])
def test_times_are_those_of_the_formula_to_the_bit(whole):
    rng = np.random.default_rng(3)
    lanes = aligned(1, CANDIDATES)
    tied = 0
    for count in [*range(1, 14), LANES]:
        motions = spheres(rng, LANES + 9, whole)
        candidates = rng.permutation(len(motions)).astype(np.uint32)
        start = 3
        for k in (0, 7):
            first = by_vectors(lanes, motions, k, candidates, start, count, 1.0)
            expected = [by_formula(motions, k, int(p), 1.0) for p in candidates[start : start + count]]
            assert lanes["due"][0, :count].tolist() == expected
            assert lanes["earliest"][0] == min(expected)
            if min(expected) < np.inf:
                assert expected[first] == min(expected)
                several = expected.count(min(expected)) > 1
                assert lanes["tied"][0] != 0 or not several
                tied += several
    assert tied > 0 or not whole


def test_nobody_is_never_touched():
    lanes = aligned(1, CANDIDATES)
    motions = spheres(np.random.default_rng(0), 2, False)
    by_vectors(lanes, motions, 0, np.zeros(1, np.uint32), 0, 0, 1.0)
    assert lanes["earliest"][0] == np.inf
