"""Gaps of surfaces: those of FCL, from any start, and no more than what was asked for."""

import numpy as np
import pytest

from harness.narrowphase.free_flight import orientation, place
from harness.narrowphase.gap import EXACT, Accuracy, mesh_gap, mesh_gap_shape
from harness.narrowphase.gjk import relative_pose
from harness.narrowphase.mesh_advancement import MESH_COLD_START
from harness.narrowphase.surface_gap import search_scratch
from harness.narrowphase.vectors import minus
from tests.narrowphase.flights import Truth, encounter
from tests.narrowphase.meshes import MESHES, mesh_named


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES[:3])
def test_the_gap_is_that_of_fcl_from_a_cold_and_from_any_warm_start(name):
    mesh, scratch, start = mesh_named(name), search_scratch(), MESH_COLD_START
    shape = mesh_gap_shape(mesh)
    for seed in range(30):
        a, b = encounter(seed, 0.0, apart=(0.8, 1.5))
        offset = minus(place(b, 0.0), place(a, 0.0))
        pose = relative_pose(orientation(a, 0.0), a.size, orientation(b, 0.0), b.size, offset)
        truth = Truth(mesh, a, b)
        expected = 0.0 if truth.touch(0.0) else truth.distance(0.0)
        cold, _ = mesh_gap(shape, shape, pose, MESH_COLD_START, EXACT, scratch)
        warm, start = mesh_gap(shape, shape, pose, start, EXACT, scratch)  # of another pose and other sizes
        assert cold.upper == pytest.approx(expected, abs=1e-13)
        assert warm.upper == pytest.approx(expected, abs=1e-13)
        assert expected - 1e-13 <= cold.lower + 1e-13 <= cold.upper + 2e-13
        rough, _ = mesh_gap(shape, shape, pose, MESH_COLD_START, Accuracy(np.inf, 0.0, 0.01), scratch)
        assert rough.lower - 1e-13 <= expected <= rough.upper + 1e-13
        assert rough.upper - rough.lower <= 0.01 + 1e-13
        if expected > 0:
            beyond, _ = mesh_gap(shape, shape, pose, start, Accuracy(0.99 * expected, 0.0, 0.0), scratch)
            assert beyond.upper == np.inf
            near, _ = mesh_gap(shape, shape, pose, start, Accuracy(1.01 * expected, 1.01 * expected, 0.0), scratch)
            assert near.upper <= 1.01 * expected
