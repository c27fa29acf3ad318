"""Closed forms that the scheduler must meet."""

from math import pi, sqrt

import numpy as np
import pytest

from harness.motion.predictive.codes import Event
from harness.motion.predictive.simulation import Simulation

FAR = [1e3, 1e3, 1e3]


def fly(
    positions,
    velocities,
    until=np.inf,
    *,
    radius=0.5,
    masses=None,
    half_box=FAR,
    response="elastic",
    hits=None,
    **options,
):
    """The recorded flight of spheres of one radius."""
    count = len(positions)
    radii = np.broadcast_to(radius, count)
    masses = np.ones(count) if masses is None else masses
    simulation = Simulation(positions, velocities, radii, masses, half_box, response, record=True, **options)
    simulation.advance(until, max_events=hits)
    return simulation


def pairs(simulation):
    events = simulation.events
    return events[events["kind"] == Event.PAIR]


def along_x(xs):
    return [(x, 0.0, 0.0) for x in xs]


@pytest.mark.parametrize("speed", [1.0, 1e-8, 1e8, 1e-12, 1e12])
@pytest.mark.parametrize("response", ["elastic", "reflect"])
def test_head_on_at_any_speed(speed, response):
    simulation = fly(along_x([-2, 2]), along_x([speed, -speed]), 2 / speed, response=response)
    (hit,) = simulation.events
    assert hit["time"] * speed == pytest.approx(1.5, rel=1e-15)
    assert np.allclose(simulation.velocities[:, 0] / speed, [-1, 1], rtol=1e-15)


@pytest.mark.parametrize("offset", [0.0, 0.3, 0.5, 0.9, 0.999])
def test_an_oblique_hit_comes_when_the_circles_meet(offset):
    simulation = fly([(-3, offset, 0), (0, 0, 0)], along_x([2.0, 0.0]), 10)
    assert simulation.events[0]["time"] == pytest.approx((3 - sqrt(1 - offset**2)) / 2, abs=1e-15)
    normal = np.array([sqrt(1 - offset**2), -offset, 0])
    assert np.allclose(simulation.velocities[1], 2 * normal[0] * normal, atol=1e-14)


@pytest.mark.parametrize("margin", [1e-9, 1e-12])
@pytest.mark.parametrize("distance", [2.0, 900.0])
@pytest.mark.parametrize("response", ["elastic", "reflect", "none"])
def test_a_grazing_pass_is_a_hit_only_inside_the_sum_of_radii(margin, distance, response):
    for offset, hits in ((1 - margin, 1), (1 + margin, 0)):
        simulation = fly([(-distance, offset, 0), (0, 0, 0)], along_x([1.0, 0.0]), distance + 50, response=response)
        assert len(pairs(simulation)) == hits


@pytest.mark.parametrize("ratio", [1.0, 3.0, 1e6, 1e12])
def test_unequal_masses_head_on(ratio):
    simulation = fly(along_x([-2, 2]), along_x([1.0, 0.0]), 10, masses=[ratio, 1.0])
    total = ratio + 1
    assert np.allclose(simulation.velocities[:, 0], [(ratio - 1) / total, 2 * ratio / total], rtol=1e-15, atol=2e-16)
    light = fly(along_x([-2, 2]), along_x([1.0, 0.0]), 10, masses=[1.0, ratio])
    assert np.allclose(light.velocities[:, 0], [(1 - ratio) / total, 2 / total], rtol=1e-15, atol=2e-16)


@pytest.mark.parametrize("count", [5, 20, 50])
@pytest.mark.parametrize("gap", [0.0, 1e-12])
def test_a_cradle_hands_the_speed_through(count, gap):
    cradle = [k * (1 + gap) for k in range(count)]
    simulation = fly(along_x([-3, *cradle]), along_x([1.0] + [0.0] * count), 5)
    assert len(pairs(simulation)) == count
    assert np.allclose(simulation.velocities[:, 0], [0.0] * count + [1.0], atol=1e-14)


def test_two_into_a_cradle_of_five_send_two_out():
    simulation = fly(along_x([-4, -3, *range(5)]), along_x([1.0, 1.0] + [0.0] * 5), 5)
    assert len(pairs(simulation)) == 10
    assert np.allclose(simulation.velocities[:, 0], [0] * 5 + [1, 1], atol=1e-14)


def test_a_sandwich_turns_inside_out():
    simulation = fly(along_x([-3, 0, 3]), along_x([1.0, 0.0, -1.0]), 4)
    assert len(pairs(simulation)) == 3
    assert np.allclose(simulation.velocities[:, 0], [-1, 0, 1], atol=1e-15)


def test_an_implosion_of_six_leaves_the_centre_at_rest():
    arms = np.array([s * np.eye(3)[a] for a in range(3) for s in (1, -1)])
    simulation = fly([(0, 0, 0), *(3 * arms)], [(0, 0, 0), *(-arms)], 4)
    assert len(pairs(simulation)) == 9
    assert np.allclose(simulation.velocities, [(0, 0, 0), *arms], atol=1e-14)


def test_one_into_two_touching_is_answered_in_order():
    """Ill-posed: the true answer depends on which pair is first; (time, i, j) decides."""
    side = sqrt(3) / 2
    simulation = fly([(-2, 0, 0), (side, 0.5, 0), (side, -0.5, 0)], along_x([1.0, 0.0, 0.0]), 5)
    expected = [(-0.125, -0.217), (0.75, 0.433), (0.375, -0.217)]
    assert np.allclose(simulation.velocities[:, :2], expected, atol=1e-3)


def test_a_corner_sends_back_where_it_came_from():
    simulation = fly([(0, 0, 0)], [(1, 1, 1)], 11, half_box=[6, 6, 6])
    assert len(simulation.events) == 3
    assert np.allclose(simulation.positions, 0, atol=8e-15)
    assert np.array_equal(simulation.velocities, [[-1, -1, -1]])


def triangle_wave(x, limit):
    folded = (x + limit) % (4 * limit)
    return np.where(folded < 2 * limit, folded - limit, 3 * limit - folded)


@pytest.mark.parametrize("response", ["elastic", "none"])
def test_one_sphere_folds_for_five_hours(response):
    start, velocity, half = np.array([0.1, -0.2, 0.3]), np.array([1.1, -0.7, 0.31]), np.array([2.0, 3.0, 1.7])
    simulation = fly([start], [velocity], 18000.0, half_box=half, response=response)
    assert np.allclose(simulation.positions[0], triangle_wave(start + velocity * 18000.0, half - 0.5), atol=1e-10)


def test_times_of_a_billion_seconds_keep_their_digits():
    simulation = Simulation([(0, 0, 0)], [(1e-3, 0, 0)], [0.5], [1.0], [1.5, 1.5, 1.5], record=True)
    simulation.advance(1e9)
    times = simulation.events["time"]
    assert len(times) == 500_000
    assert np.abs(times - (1000.0 + 2000.0 * np.arange(len(times)))).max() <= 1e-6
    assert abs(simulation.positions[0, 0]) <= 1e-9


@pytest.mark.parametrize("digits", range(6))
def test_galperins_billiard_counts_the_digits_of_pi(digits):
    """Masses 1 and 100^k and a wall: floor(pi 10^k) hits."""
    half = 1e3
    simulation = Simulation(
        along_x([3 - half, 5 - half]), along_x([0.0, -1.0]), [0.5, 0.5], [1.0, 100.0**digits], [half, 10, 10], "elastic"
    )
    simulation.advance(900.0)  # both are on their way to the far wall by then
    assert 0 <= simulation.velocities[0, 0] <= simulation.velocities[1, 0]
    assert simulation.counters["events"] == int(pi * 10**digits)
    assert simulation.counters["stalled_events"] == 0


def test_speed_does_not_tunnel():
    simulation = fly([(-900, 0.3, 0), (0, 0, 0)], along_x([1e6, 0.0]), 1e-2, half_box=[1e3, 5, 5])
    (hit,) = pairs(simulation)[:1]
    assert hit["time"] == pytest.approx((900 - sqrt(1 - 0.09)) / 1e6, rel=1e-15)


@pytest.mark.slow
def test_no_hit_is_missed_from_a_hundred_million_diameters():
    """Aimed at the target but for 1e-7 of its radius, from 1e8 diameters; direction and offset are exact in binary."""
    rng = np.random.default_rng(1)
    axes = rng.permuted(np.tile([0, 1, 2], (2000, 1)), axis=1)
    for inside, expected in ((True, 1), (False, 0)):
        for along, across, _ in axes[:200]:
            start = np.zeros(3)
            start[along], start[across] = -1e8, 1 - 1e-7 if inside else 1 + 1e-7
            velocity = np.zeros(3)
            velocity[along] = 1.0
            simulation = fly([start, (0, 0, 0)], [velocity, (0, 0, 0)], 1.1e8, half_box=[2e8] * 3)
            assert len(pairs(simulation)) == expected


def test_a_skew_shot_from_afar_hits_within_what_its_coordinates_resolve():
    rng = np.random.default_rng(2)
    for _ in range(200):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        across = np.cross(direction, rng.normal(size=3))
        across *= rng.uniform(0, 1 - 1e-6) / np.linalg.norm(across)
        simulation = fly([across - 1e8 * direction, (0, 0, 0)], [direction, (0, 0, 0)], 1.1e8, half_box=[2e8] * 3)
        assert len(pairs(simulation)) == 1
