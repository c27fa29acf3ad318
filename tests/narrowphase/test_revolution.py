"""What spinning bodies sweep: bounds that hold however bodies turn, and searches that need no millions of steps."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from harness.motion.law import MotionLaw
from harness.narrowphase.advancement import MOST_STEPS, time_of_impact, time_of_wall_impact
from harness.narrowphase.gjk import COLD_START
from harness.narrowphase.revolution import apart_from_wall_until, apart_until
from harness.narrowphase.support import support_map
from harness.narrowphase.verdicts import SearchVerdict
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, examples, make_bodies
from tests.methods import flights
from tests.narrowphase.meshes import MESHES, mesh_named, turns
from tests.narrowphase.test_advancement import CUBE, WIDTH, body, gap_at

RIM = WIDTH / np.sqrt(2)
"""m, from the axis of a cube of diameter 1 that spins about an axis of its own to an edge."""


def spinning_pair(rate, speed, gap):
    """Cubes that spin about z, one the other way round and in another phase; what they sweep is `gap` apart."""
    turned = (np.cos(0.2), 0.0, 0.0, np.sin(0.2))
    return (
        body(spin=(0, 0, rate)),
        body(position=(2 * RIM + gap, 0, 0), velocity=(-speed, 0, 0), spin=(0, 0, -1.37 * rate), quaternion=turned),
    )


def until_found(a, b, hull, tolerance):
    """Search on from where each search was given up: the time, and the steps of all."""
    time, steps = 0.0, 0
    while True:
        found = time_of_impact(hull, hull, a, b, time, np.inf, tolerance, COLD_START)
        steps += found.steps
        if found.verdict != SearchVerdict.STALLED:
            return found, steps
        assert found.time > time
        time = found.time


def test_cylinders_are_apart_until_their_sides_touch():
    a, b = spinning_pair(1e4, 2e-3, 0.5)
    assert apart_until(CUBE, CUBE, a, b, 0.0) == pytest.approx(0.5 / 2e-3, rel=1e-9)
    assert apart_until(CUBE, CUBE, a, b, 100.0) == pytest.approx(0.5 / 2e-3, rel=1e-9)
    parting = b._replace(velocity=(1e-3, 0.0, 0.0))
    assert apart_until(CUBE, CUBE, a, parting, 3.0) == np.inf
    inside = b._replace(position=(1.9 * RIM, 0.0, 0.0))
    assert apart_until(CUBE, CUBE, a, inside, 3.0) == 3.0


def test_bodies_that_do_not_spin_sweep_themselves():
    a, b = body(), body(position=(3, 0.1, 0.2), velocity=(-1, 0, 0))
    assert 0.98 * (3 - WIDTH) <= apart_until(CUBE, CUBE, a, b, 0.0) <= 3 - WIDTH


@pytest.mark.parametrize("rate", [1e2, 1e4])
def test_an_edge_that_passes_a_wall_meets_it_within_a_quarter_turn_of_the_time_at_which_it_can(rate):
    speed, far = 1e-3, 0.5
    flight = body(velocity=(speed, 0, 0), spin=(0, 0, rate))
    can = far / speed
    assert apart_from_wall_until(CUBE, flight, (-1.0, 0.0, 0.0), RIM + far, 0.0) == pytest.approx(can, rel=1e-9)
    time, steps = 0.0, 0
    while True:
        found = time_of_wall_impact(CUBE, flight, 1, RIM + far, time, np.inf, 1e-6)
        time, steps = found.time, steps + found.steps
        if found.verdict == SearchVerdict.FOUND:
            break
    assert can - 1e-6 / speed <= time <= can + np.pi / 2 / rate
    assert steps < 20 * MOST_STEPS


@pytest.mark.parametrize("rate", [pytest.param(1e1, marks=pytest.mark.slow), 1e3])
def test_cubes_that_spin_fast_and_approach_slowly_meet_when_edges_pass_each_other(rate):
    speed, gap, tolerance = 1e-3, 0.02, 1e-6
    a, b = spinning_pair(rate, speed, gap)
    found, steps = until_found(a, b, CUBE, tolerance)
    can = gap / speed
    assert found.time >= can - tolerance / speed
    assert 0.0 <= gap_at(a, b, CUBE, found.time) <= 1.01 * tolerance
    # without what they sweep: about speed of points / speed of centres x the logarithm of gap / tolerance
    assert steps < 0.02 * 2.4 * rate * RIM / speed * np.log(gap / tolerance)
    earlier = np.linspace(max(0.0, found.time - 20 / rate), found.time - tolerance / rate, 20_000)
    assert min(gap_at(a, b, CUBE, time) for time in earlier[:: max(1, int(rate // 10))]) > 0.0


@settings(max_examples=examples(60), deadline=None)
@given(st.integers(0, 10_000), st.sampled_from(sorted(MESHES)))
def test_nothing_touches_before_what_is_swept_does(seed, name):
    rng = np.random.default_rng(seed)
    hull = support_map(mesh_named(name).hull.vertices)
    one, other = turns(rng, 2)
    offset = rng.normal(size=3)
    offset *= rng.uniform(0.8, 2.5) / np.linalg.norm(offset)
    a = body(quaternion=one, spin=rng.normal(size=3) * rng.choice([0, 1, 10]))
    b = body(
        position=offset,
        velocity=-offset * rng.uniform(0.1, 2) + rng.normal(size=3) * 0.2,
        quaternion=other,
        spin=rng.normal(size=3) * rng.choice([0, 1, 10]),
        size=rng.uniform(0.3, 1.5),
    )
    b = b._replace(reach=b.size / 2)
    until = apart_until(hull, hull, a, b, 0.0)
    assume(until > 0.0)
    found = time_of_impact(hull, hull, a, b, 0.0, min(until, 50.0), 1e-9, COLD_START)
    assert found.verdict == SearchVerdict.NEVER or found.time >= until - 1e-8 / 0.05


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_a_slow_approach_in_a_fast_spin_is_predicted_to_the_tolerance(shape):
    speed, gap, rate = 1e-2, 0.02, 1e3
    a, b = spinning_pair(rate, speed, gap)
    bodies = make_bodies(
        np.array([a.position, b.position]) - [0.5, 0, 0],
        velocities=np.array([a.velocity, b.velocity]),
        quaternions=np.array([a.quaternion, b.quaternion]),
        spins=np.array([a.spin, b.spin]),
    )
    scene = Scene(shape, (cube_mesh(),), bodies, Box(np.full(3, 5.0)))
    outcome = flights.fly(scene, "predictive", MotionLaw(3.0, 3.0, "elastic"))
    trace = outcome.trace
    assert outcome.metrics["stalled_events"] == 0
    found, _ = until_found(a, b, CUBE, 1e-6)
    pairs = trace.walls < 0
    assert trace.times[pairs][0] == pytest.approx(found.time, abs=2e-6 / speed)
    assert outcome.metrics["advancement_steps"] < 300_000


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "rate", "most"), [("hull", 1e3, 1e5), ("mesh", 1e1, 4e6)])
def test_pumpkins_that_spin_fast_and_approach_slowly_are_predicted_without_a_wait(shape, rate, most):
    bodies = make_bodies(
        [[-0.51, 0.01, 0.0], [0.51, 0.0, 0.02]],
        velocities=[[5e-4, 0, 0], [-5e-4, 0, 0]],
        spins=[[0.1, rate, 0.2], [0.3, 0.1, -0.7 * rate]],
    )
    scene = Scene(shape, (mesh_named("pumpkin-1753.ply"),), bodies, Box(np.full(3, 5.0)))
    outcome = flights.fly(scene, "predictive", MotionLaw(60.0, 60.0, "elastic"))
    assert (outcome.metrics["pair_hits"], outcome.metrics["stalled_events"]) == (1, 0)
    assert outcome.metrics["advancement_steps"] < most
