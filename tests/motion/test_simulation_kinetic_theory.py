"""Fluids of hard spheres against kinetic theory and their own conservation laws."""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

from harness.motion.predictive.simulation import Simulation
from tests.motion.fluids import fluid


def carnahan_starling(eta):
    """Pressure of the bulk, in kT / diameter^3."""
    return 6 * eta / pi * (1 + eta + eta**2 - eta**3) / (1 - eta) ** 3


def wall_tension(eta):
    return -9 * eta**2 * (1 + eta) / (2 * pi * (1 - eta) ** 3)


def pressure_between_walls(count, reach):
    """Mean force on a face to reach^2, for `count` spheres of diameter 1 whose centres have a cube of side `reach`."""

    def slope(function, eta, step=1e-5):
        return (function(eta + step) - function(eta - step)) / (2 * step)

    def surplus(eta):
        density = 6 * eta / pi
        adsorbed = -density * slope(wall_tension, eta) / slope(carnahan_starling, eta)
        return density * reach**3 + 6 * reach**2 * adsorbed - count

    eta = brentq(surplus, 1e-4, 0.6)
    return carnahan_starling(eta) - 4 * wall_tension(eta) / reach


@pytest.mark.slow
@pytest.mark.parametrize("packing", [0.1, 0.3, 0.45])
def test_a_thousand_spheres_press_and_collide_as_theory_says(packing):
    simulation = fluid(1000, packing, melt=100)
    simulation.advance(np.inf, max_events=3_000_000)
    temperature = 2 * simulation.kinetic_energy / (3 * 1000)
    counters = simulation.counters
    mean_impulse = simulation.pair_impulses / (counters["pair_hits"] * sqrt(pi * temperature))
    assert mean_impulse == pytest.approx(1, abs=0.003)
    reach = 2 * simulation._start.half_box[0] - 1
    assert simulation.pressure / temperature == pytest.approx(pressure_between_walls(1000, reach), rel=0.015)
    assert abs(simulation.virial_residual) <= 1e-12
    rate = simulation.wall_impulses.sum() / simulation.time / sqrt(2 * pi * temperature)
    assert counters["box_hits"] / simulation.time == pytest.approx(rate, rel=0.01)
    assert counters["stalled_events"] == 0


@pytest.mark.slow
def test_energy_stays_over_a_million_collisions():
    simulation = fluid(1000, 0.3, melt=1)
    before = simulation.kinetic_energy
    simulation.advance(np.inf, max_events=1_000_000)
    assert abs(simulation.kinetic_energy / before - 1) <= 1e-12


@pytest.mark.slow
def test_speeds_become_maxwells_for_a_fixed_energy():
    simulation = fluid(1000, 0.2, melt=100)
    moments = []
    for _ in range(400):
        simulation.advance(np.inf, max_events=2000)
        square = (simulation.velocities**2).sum(axis=1)
        moments.append((square**2).mean() / square.mean() ** 2)
    assert np.mean(moments) == pytest.approx(5 / 3 * 3000 / 3002, rel=0.005)


def test_momentum_is_kept_by_pairs():
    """Only walls change it: the velocities' sum is the impulse of the faces."""
    simulation = fluid(500, 0.3, melt=1)
    before = simulation.velocities.sum(axis=0)
    simulation.advance(5.0)
    faces = simulation.wall_impulses.reshape(3, 2)
    assert np.allclose(simulation.velocities.sum(axis=0) - before, faces[:, 0] - faces[:, 1], atol=1e-9)


@pytest.mark.parametrize(("collisions", "error"), [(2, 1e-12), (15, 1e-8), (20, 1e-6)])
@pytest.mark.parametrize("search", ["cells", "lists"])
def test_time_runs_backwards_to_the_start(collisions, error, search):
    forth = fluid(1000, 0.3, melt=30, search=search)
    start = forth.positions
    forth.advance(np.inf, max_events=int(collisions * 1000 / 2 * 1.2))
    end = forth._start
    back = Simulation(forth.positions, -forth.velocities, end.radii, end.masses, end.half_box, "elastic", search=search)
    back.advance(forth.time)
    assert np.abs(back.positions - start).max() <= error
    assert forth.counters["pair_hits"] >= collisions * 1000 / 2


@pytest.mark.parametrize("packing", [0.1, 0.3, 0.45])
def test_cells_and_lists_tell_the_same_story(packing):
    one, other = (fluid(800, packing, melt=10, search=search, record=True) for search in ("cells", "lists"))
    one.advance(np.inf, max_events=4000)
    other.advance(np.inf, max_events=4000)
    assert (one.search, other.search) == ("cells", "lists")
    for name in ("kind", "i", "j", "wall"):
        assert np.array_equal(one.events[name], other.events[name])
    assert np.allclose(one.events["time"], other.events["time"], atol=1e-9)


@pytest.mark.slow
def test_the_work_for_an_event_does_not_grow_with_the_crowd():
    counts = np.array([1000, 8000, 64000])
    work = []
    for count in counts:
        simulation = fluid(int(count), 0.3, melt=5)
        simulation.advance(np.inf, max_events=2 * int(count))
        work.append(simulation.counters["predictions"] / simulation.counters["events"])
    exponent = np.polyfit(np.log(counts), np.log(work), 1)[0]
    assert abs(exponent) <= 0.05


def test_memory_in_order_or_not_is_the_same_physics():
    """Beyond 2048 spheres rows move in memory during the run."""
    simulation = fluid(4000, 0.3, melt=3)
    simulation.advance(np.inf, max_events=300_000)
    assert abs(simulation.virial_residual) <= 1e-12
    x = simulation.positions
    assert np.abs(x).max() <= simulation._start.half_box[0] - 0.5 + 1e-9
    from scipy.spatial import KDTree

    assert KDTree(x).query(x, k=2)[0][:, 1].min() >= 1 - 1e-12
