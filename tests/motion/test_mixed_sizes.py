"""Spheres of several sizes: whichever way they find each other, what happens is the same, and the work is bounded."""

from math import inf

import numpy as np
import pytest

from harness.motion.predictive import grids
from harness.motion.predictive.simulation import Simulation
from harness.motion.predictive.state import LARGER_CAPACITY
from harness.scene.random_packing import add_at_random


def flown(positions, velocities, radii, half, response, hits=1500):
    simulation = Simulation(positions, velocities, radii, radii**3, half, response, record=True)
    simulation.advance(inf, max_events=hits)
    return simulation


def placed(radii, half, seed):
    rng = np.random.default_rng(seed)
    order = np.argsort(-radii)
    positions = np.empty((len(radii), 3))
    positions[order] = add_at_random(radii[order], half, rng)
    return positions, rng.normal(size=(len(radii), 3))


def same_events(one, other, within):
    assert len(one.events) == len(other.events)
    for name in ("kind", "i", "j", "wall"):
        assert np.array_equal(one.events[name], other.events[name])
    assert np.abs(one.events["time"] - other.events["time"]).max() <= within


@pytest.mark.parametrize("response", ["elastic", "reflect", "none"])
def test_one_grid_and_several_find_the_same_hits(response, monkeypatch):
    radii, half = np.r_[np.full(4, 3.0), np.full(40, 0.9), np.full(300, 0.2)], np.full(3, 9.0)
    start = placed(radii, half, 3)
    monkeypatch.setattr(grids, "MOST_AROUND", 0.0)
    hits = 4000 if response == "none" else 300  # what rounding does grows with every hit
    several = flown(*start, radii, half, response, hits)
    monkeypatch.setattr(grids, "MOST_AROUND", inf)
    one = flown(*start, radii, half, response, hits)
    assert (several._world.cells.grids.size, one._world.cells.grids.size) == (3, 1)
    same_events(several, one, 1e-12 if response == "none" else 1e-9)


def test_without_room_for_the_cells_around_the_large_ones_all_is_as_with_it(monkeypatch):
    radii, half = np.r_[np.full(6, 3.0), np.full(500, 0.25)], np.full(3, 10.0)
    start = placed(radii, half, 4)
    kept = flown(*start, radii, half, "elastic")
    monkeypatch.setattr(grids, "REGISTERED_PER_SPHERE", 0)
    sought = flown(*start, radii, half, "elastic")
    assert kept._world.cells.registered_at.size > 0
    assert sought._world.cells.registered_at.size == 0
    same_events(kept, sought, 0.0)


@pytest.mark.parametrize("response", ["reflect", "none"])
def test_more_large_ones_in_one_place_than_a_cell_has_room_for(response, monkeypatch):
    rng = np.random.default_rng(5)
    radii, half = np.r_[np.full(20, 2.0), np.full(200, 0.2)], np.full(3, 8.0)
    positions = np.r_[rng.normal(size=(20, 3)) * 0.5, rng.uniform(-7.5, 7.5, (200, 3))]
    velocities = rng.normal(size=positions.shape)
    several = flown(positions, velocities, radii, half, response, hits=600)
    assert several._world.cells.larger["count"].max() > LARGER_CAPACITY
    monkeypatch.setattr(grids, "MOST_AROUND", inf)
    same_events(
        several, flown(positions, velocities, radii, half, response, hits=600), 1e-12 if response == "none" else 1e-9
    )


@pytest.mark.parametrize("low", [0.1, 0.3])
def test_sizes_of_all_kinds_ask_about_few_of_the_others(low):
    """With the few smallest in wide cells of their own, and the others in cells as wide, it was half of all."""
    rng = np.random.default_rng(6)
    radii = rng.uniform(low, 1.0, 1500)
    half = np.full(3, 0.5 * (4.19 * (radii**3).sum() / 0.1) ** (1 / 3))
    simulation = flown(*placed(radii, half, 7), radii, half, "reflect", hits=3000)
    counters = simulation.counters
    assert counters["pair_tests"] < 60 * counters["predictions"]


def test_twenty_large_ones_among_many_small_ones_are_asked_about_nearby():
    radii, half = np.r_[np.full(20, 5.0), np.full(2500, 0.5)], np.full(3, 0.5 * (4.19 * 2812 / 0.25) ** (1 / 3))
    simulation = flown(*placed(radii, half, 8), radii, half, "reflect", hits=3000)
    searches = simulation.counters["predictions"] + simulation.counters["cell_crossings"]
    assert simulation.counters["pair_tests"] < 20 * searches  # of the large ones alone it was 20
