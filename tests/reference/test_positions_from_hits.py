"""The motion from its hits alone."""

import numpy as np
import pytest

from harness.motion.law import MotionLaw
from harness.reference.events import Events
from harness.reference.positions_from_hits import positions_at
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import make_bodies
from tests.methods.flights import fly


@pytest.mark.parametrize(("response", "restitution"), [("reflect", 1.0), ("elastic", 1.0), ("elastic", 0.7)])
def test_the_hits_of_a_run_tell_where_its_bodies_were(response, restitution):
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(*[[-1.2, 0.0, 1.2]] * 3), axis=-1).reshape(-1, 3)
    bodies = make_bodies(grid, rng.normal(size=grid.shape), sizes=rng.uniform(0.5, 1.0, len(grid)))
    scene = Scene("sphere", (), bodies, Box(np.full(3, 2.0)))
    trace = fly(scene, "predictive", MotionLaw(2.0, 1.0, response, restitution)).trace
    assert len(trace.times) > 50
    times = np.array([0.5, 1.0, 2.0])
    found = positions_at(times, bodies, Events.of(trace), response, restitution)
    for time, positions in zip(times, found, strict=True):
        flown = fly(scene, "predictive", MotionLaw(time, 1.0, response, restitution)).trace
        np.testing.assert_allclose(positions, flown.positions, rtol=0, atol=1e-10)
