"""Gaps of the pairs of a frame: those of each pair by itself, whatever was remembered of the frame before."""

from itertools import combinations

import numpy as np
import pytest

import harness
from harness.narrowphase.gap import EXACT, Accuracy
from harness.narrowphase.gap_pairs import HullGapPairs, MeshGapPairs
from harness.narrowphase.placement import Places
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import turns

PAIRS = np.array(list(combinations(range(8), 2)), np.int64)


@pytest.mark.parametrize(("shape", "kernel"), [("hull", HullGapPairs), ("mesh", MeshGapPairs)])
def test_a_frame_after_another_gives_the_gaps_of_each_pair_by_itself(shape, kernel):
    rng, mesh = np.random.default_rng(2), cube_mesh()
    sizes = rng.uniform(0.5, 2.0, 8)
    positions, q = rng.uniform(-2, 2, (8, 3)), turns(rng, 8)
    places, asked = Places(sizes), kernel([mesh.hull if shape == "hull" else mesh], np.zeros(8, np.int64))
    for frame in range(3):
        positions = positions + 0.1 * rng.normal(size=(8, 3))
        pairs = PAIRS[frame::2].copy()  # as a broad phase gives them; some are new, some are gone
        bodies = [harness.Body(mesh, x, t, s, shape=shape) for x, t, s in zip(positions, q, sizes, strict=True)]
        expected = [harness.distance(bodies[i], bodies[j]).gap for i, j in pairs]
        placement = places.at(positions, q)
        found = asked.gaps(pairs, placement, EXACT)
        assert found.gaps == pytest.approx(expected, rel=1e-14, abs=1e-14)
        assert np.linalg.norm(found.points[:, 0] - found.points[:, 1], axis=1) == pytest.approx(expected, abs=1e-13)
        within = Accuracy(0.5 * placement.scale, 0.5 * placement.scale, 0.0)
        near = asked.gaps(pairs, placement, within).gaps <= 0.5
        assert near.tolist() == [gap <= 0.5 for gap in expected]
