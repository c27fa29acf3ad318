"""Overlaps, walls, ties, bursts, sampling, recording: the rules that keep a run right."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.errors import InputError
from harness.motion.predictive import grids
from harness.motion.predictive.codes import Event
from harness.motion.predictive.simulation import Simulation
from harness.motion.predictive.state import CAPACITY
from harness.scene.random_packing import add_at_random


def gas(count=200, packing=0.2, seed=3, response="elastic", ratio=1.0, **options):
    """Spheres at random, overlaps allowed."""
    rng = np.random.default_rng(seed)
    radii = 0.5 * ratio ** rng.uniform(-1, 0, count)
    half = np.full(3, 0.5 * ((8 * radii**3).sum() * np.pi / 6 / packing) ** (1 / 3))
    positions = rng.uniform(-1, 1, (count, 3)) * (half - radii[:, None])
    return Simulation(positions, rng.normal(size=(count, 3)), radii, radii**3, half, response, **options)


def state(simulation):
    return np.concatenate([simulation.positions, simulation.velocities])


@pytest.mark.slow
@pytest.mark.parametrize("response", ["elastic", "reflect", "none"])
@pytest.mark.parametrize("packing", [0.2, 0.5])
def test_sampling_does_not_disturb_a_bit(response, packing):
    plain = gas(response=response, packing=packing, record=True)
    sampled = gas(response=response, packing=packing, record=True)
    plain.advance(3.0)
    for time in np.linspace(0, 3, 400):
        sampled.advance(time)
        sampled.positions_at(time)
        sampled.virial_residual  # noqa: B018
    assert np.array_equal(plain.events, sampled.events)
    assert np.array_equal(state(plain), state(sampled))
    assert plain.counters == sampled.counters


def test_positions_between_events_lie_on_the_flight():
    simulation = gas(count=50, record=True)
    before = simulation.positions_at(1.0)
    velocities = simulation.velocities
    after = simulation.positions_at(1.0 + 1e-9)
    assert np.allclose(after - before, 1e-9 * velocities, atol=1e-14)
    with pytest.raises(ValueError, match="past"):
        simulation.positions_at(0.5)


def test_events_are_cut_by_number_and_by_time():
    whole = gas(record=True)
    whole.advance(2.0)
    pieces = gas(record=True)
    while not pieces.advance(2.0, max_events=7):
        pass
    assert np.array_equal(whole.events, pieces.events)
    times = whole.events["time"]
    exactly = gas(record=True)
    exactly.advance(times[10])
    assert exactly.counters["events"] == np.searchsorted(times, times[10], side="right")


def test_taken_events_are_forgotten():
    simulation = gas(record=True)
    simulation.advance(1.0)
    first = simulation.take_events()
    assert len(first) == simulation.counters["events"]
    assert len(simulation.events) == 0
    simulation.advance(2.0)
    assert simulation.events["time"].min() > first["time"].max()


def test_a_long_record_comes_in_chunks_and_in_order():
    simulation = gas(count=500, packing=0.3, record=True)
    simulation.advance(np.inf, max_events=200_000)
    assert len(simulation.events) == 200_000
    assert (np.diff(simulation.events["time"]) >= 0).all()


@pytest.mark.parametrize("response", ["elastic", "reflect"])
def test_overlapping_spheres_part_and_do_not_stick(response):
    simulation = Simulation(
        [(0, 0, 0), (0.3, 0, 0)], [(1, 0, 0), (-1, 0, 0)], [0.5] * 2, [1] * 2, [5] * 3, response, record=True
    )
    simulation.advance(1.0)
    assert [event["time"] for event in simulation.events] == [0.0]
    assert np.allclose(simulation.positions[:, 0], [-1, 1.3])


def test_spheres_at_one_place_have_no_normal_and_no_hit():
    simulation = Simulation(
        np.zeros((3, 3)), [(1, 0, 0), (-1, 0, 0), (0, 0, 0)], [0.5] * 3, [1] * 3, [5] * 3, record=True
    )
    simulation.advance(4.0)
    assert simulation.counters["pair_hits"] == 0
    assert np.isfinite(simulation.positions).all()


def test_touching_spheres_that_slide_along_each_other_do_not_stall():
    rng = np.random.default_rng(5)
    for _ in range(200):
        normal, velocity = rng.normal(size=(2, 3))
        normal /= np.linalg.norm(normal)
        velocity -= (velocity @ normal) * normal
        simulation = Simulation([(0, 0, 0), normal], [(0, 0, 0), velocity], [0.5] * 2, [1] * 2, [50] * 3, "elastic")
        simulation.advance(1.0, max_events=100)
        assert simulation.counters["events"] <= 1
        assert simulation.counters["predictions"] <= 6


@pytest.mark.parametrize("speed", [1.0, 1e6, 1e12])
@pytest.mark.parametrize("response", ["elastic", "reflect", "none"])
def test_no_centre_leaves_the_box_whatever_the_speed(speed, response):
    rng = np.random.default_rng(4)
    positions = rng.uniform(-2, 2, (20, 3))
    velocities = rng.normal(size=(20, 3))
    velocities[:3] *= speed
    simulation = Simulation(positions, velocities, [0.2] * 20, [1] * 20, [2.5, 2.6, 2.7], response)
    for _ in range(50):
        simulation.advance(np.inf, max_events=400)
        assert (np.abs(simulation.positions) <= np.array([2.3, 2.4, 2.5]) * (1 + 1e-9)).all()


def test_a_sphere_beyond_a_wall_is_sent_in_and_let_in():
    outward = Simulation([(5, 0, 0)], [(1, 0, 0)], [0.5], [1], [2] * 3, record=True)
    outward.advance(3.0)
    assert [(event["time"], event["wall"]) for event in outward.events] == [(0.0, 1)]
    assert outward.positions[0, 0] == pytest.approx(2.0)
    inward = Simulation([(5, 0, 0)], [(-1, 0, 0)], [0.5], [1], [2] * 3, record=True)
    inward.advance(6.6)
    assert [(event["time"], event["wall"]) for event in inward.events] == [(pytest.approx(6.5), 0)]


def test_a_box_barely_larger_than_the_sphere():
    simulation = Simulation([(0, 0, 0)], [(1, 0, 0)], [0.5], [1], [0.5 + 1e-6] * 3)
    simulation.advance(0.1)
    assert abs(simulation.counters["box_hits"] - 0.1 / 2e-6) <= 1
    assert abs(simulation.positions[0, 0]) <= 1e-6 * (1 + 1e-9)


@pytest.mark.parametrize("response", ["elastic", "reflect"])
def test_a_box_smaller_than_the_sphere_stalls_and_says_so(response):
    simulation = Simulation([(0, 0, 0)], [(1, 0.3, 0)], [0.5], [1], [0.4] * 3, response)
    simulation.advance(1.0)
    assert simulation.counters["stalled_events"] > 0
    assert np.abs(simulation.positions).max() < 0.5


def test_a_heap_of_overlapping_mirrored_spheres_comes_to_an_end():
    rng = np.random.default_rng(0)
    for _ in range(5):
        simulation = Simulation(
            rng.uniform(-0.5, 0.5, (10, 3)), rng.normal(size=(10, 3)), [0.5] * 10, [1] * 10, [1.0] * 3, "reflect"
        )
        assert simulation.advance(2.0, max_events=5_000_000)
        assert np.isfinite(state(simulation)).all()


def test_inelastic_collapse_is_guarded_and_counted():
    """Three on a line collapse below a restitution of 7 - 4 sqrt 3 = .072."""
    for restitution, collapses in ((0.0, True), (0.05, True), (0.5, False)):
        simulation = Simulation(
            [(-2, 0, 0), (0, 0, 0), (2.3, 0, 0)],
            [(1, 0, 0), (0, 0, 0), (-1, 0, 0)],
            [0.5] * 3,
            [1] * 3,
            [1e3] * 3,
            "elastic",
            restitution,
        )
        assert simulation.advance(100.0, max_events=10_000)
        assert (simulation.counters["guarded_hits"] > 0) == collapses
        assert simulation.counters["stalled_events"] == 0


@pytest.mark.parametrize("restitution", ["9/10", "1/2", "1/5", "2/25"])
def test_hits_at_one_moment_lose_what_they_must(restitution):
    """Two balls meet a third between them at the same time: hits one after another, in exact fractions."""
    e = Fraction(restitution)
    speeds = [Fraction(1), Fraction(0), Fraction(-1)]
    hits = 0
    while speeds != sorted(speeds):
        i = hits % 2
        kick = (1 + e) * (speeds[i] - speeds[i + 1]) / 2
        speeds[i] -= kick
        speeds[i + 1] += kick
        hits += 1
    simulation = Simulation(
        [(-2, 0, 0), (0, 0, 0), (2, 0, 0)],
        [(1, 0, 0), (0, 0, 0), (-1, 0, 0)],
        [0.5] * 3,
        [1] * 3,
        [10.0] * 3,
        "elastic",
        float(e),
    )
    assert simulation.advance(2.0)
    assert simulation.counters["pair_hits"] == hits
    assert simulation.counters["guarded_hits"] == 0
    assert simulation.velocities[:, 0] == pytest.approx([float(speed) for speed in speeds], rel=1e-14)
    assert simulation.kinetic_energy == pytest.approx(float(sum(speed**2 for speed in speeds) / 2), rel=1e-14)


def test_an_inelastic_gas_cools_and_balances_its_books():
    simulation = gas(count=300, packing=0.1, restitution=0.7)
    before = simulation.kinetic_energy
    simulation.advance(20.0)
    assert simulation.kinetic_energy < 0.5 * before
    assert simulation.kinetic_energy + simulation.lost_energy == pytest.approx(before, rel=1e-12)
    assert abs(simulation.virial_residual) <= 1e-12


def test_ties_go_by_kind_then_by_numbers():
    """Three pairs meet at once, and three spheres meet walls at the same time."""
    positions = [(x, y, 0) for y in (4.0, 0.0, -4.0) for x in (-2.0, 2.0)] + [(8.0, y, 4.0) for y in (3.0, 0.0, -3.0)]
    velocities = [(-np.sign(x), 0, 0) for x, _, _ in positions[:6]] + [(1, 0, 0)] * 3
    simulation = Simulation(positions, velocities, [0.5] * 9, [1] * 9, [10, 10, 10], "elastic", record=True)
    simulation.advance(1.5)
    assert [(e["kind"], e["i"], e["j"]) for e in simulation.events] == [
        (Event.PAIR, 0, 1),
        (Event.PAIR, 2, 3),
        (Event.PAIR, 4, 5),
        (Event.WALL, 6, -1),
        (Event.WALL, 7, -1),
        (Event.WALL, 8, -1),
    ]


@pytest.mark.parametrize("response", ["elastic", "reflect", "none"])
def test_relabelling_changes_names_only(response):
    rng = np.random.default_rng(11)
    order = rng.permutation(60)
    half = np.array([3.0, 2.0, 4.0])
    sites = np.array([(x, y, z) for x in range(5) for y in range(3) for z in range(4)]) - [2.0, 1.0, 1.5]
    positions, velocities = sites + rng.uniform(-0.1, 0.1, (60, 3)), rng.normal(size=(60, 3))
    radii = rng.uniform(0.1, 0.3, 60)
    one = Simulation(positions, velocities, radii, radii**3, half, response, record=True)
    other = Simulation(
        positions[order], velocities[order], radii[order], radii[order] ** 3, half, response, record=True
    )
    one.advance(np.inf, max_events=300)
    other.advance(np.inf, max_events=300)
    assert np.allclose(one.events["time"], other.events["time"], rtol=1e-6, atol=1e-9)
    named = [sorted(order[[e["i"], e["j"]]]) if e["kind"] == Event.PAIR else [order[e["i"]], -1] for e in other.events]
    assert named == [[e["i"], e["j"]] for e in one.events]


def test_the_order_in_memory_does_not_show():
    """From 2048 spheres on, memory follows a curve through the box; names, events and positions stay the caller's."""
    rng = np.random.default_rng(12)
    count, half = 3000, 9.0
    positions, velocities = rng.uniform(-1, 1, (count, 3)) * (half - 0.5), rng.normal(size=(count, 3))
    simulation = Simulation(positions, velocities, [0.3] * count, [1.0] * count, [half] * 3, "none", record=True)
    assert np.array_equal(simulation.positions, positions)
    assert np.array_equal(simulation.velocities, velocities)
    simulation.advance(20.0)
    fold = (positions + velocities * 20.0 + half - 0.3) % (4 * (half - 0.3))
    limit = half - 0.3
    folded = np.where(fold < 2 * limit, fold - limit, 3 * limit - fold)
    assert np.allclose(simulation.positions, folded, atol=1e-11)


@pytest.mark.slow
def test_onsets_are_those_of_the_folded_paths():
    """Two ghosts on closed-form paths: the distance falls below the sum of radii exactly at the recorded times."""
    simulation = gas(count=12, packing=0.3, response="none", record=True)
    shadow = gas(count=12, packing=0.3, response="none")
    simulation.advance(30.0)
    events = simulation.events[simulation.events["kind"] == Event.PAIR]
    radii = simulation._start.radii
    times = np.linspace(0, 30, 60_001)
    paths = np.array([shadow.positions_at(t) for t in times])
    for i in range(12):
        for j in range(i + 1, 12):
            gap = np.linalg.norm(paths[:, i] - paths[:, j], axis=1) - radii[i] - radii[j]
            begins = times[1:][(gap[1:] < 0) & (gap[:-1] >= 0)]
            found = events["time"][(events["i"] == i) & (events["j"] == j)]
            # contacts shorter than the sampling are only in the record
            missing = [t for t in begins if not ((found > t - 6e-4) & (found <= t + 1e-12)).any()]
            assert missing == []
            assert len(found) - len(begins) <= 3


def test_more_spheres_in_one_place_than_a_list_holds():
    rng = np.random.default_rng(8)
    positions = rng.normal(size=(300, 3)) * 0.2
    simulation = Simulation(
        positions, rng.normal(size=(300, 3)), [0.3] * 300, [1] * 300, [1.6] * 3, "elastic", search="lists"
    )
    simulation.advance(np.inf, max_events=30_000)
    assert simulation.search == "cells"
    assert abs(simulation.virial_residual) <= 1e-12


def test_a_sphere_among_more_than_its_list_holds_though_no_cell_is_full():
    turn = np.arange(48) * np.pi * (3.0 - np.sqrt(5.0))
    height = (2.0 * np.arange(48) + 1.0) / 48.0 - 1.0
    around = np.column_stack([np.sqrt(1 - height**2) * np.cos(turn), np.sqrt(1 - height**2) * np.sin(turn), height])
    positions = np.vstack([np.zeros(3), 0.75 * around])
    velocities = np.random.default_rng(9).normal(size=(49, 3))
    flown = []
    for search in ("lists", "cells"):
        radii = [0.5] + [0.17] * 48
        simulation = Simulation(positions, velocities, radii, [1.0] * 49, [1.5] * 3, "elastic", search=search)
        if search == "lists":
            assert simulation.search == "lists"
            assert simulation._world.lists.cells["count"].max() < CAPACITY
        simulation.advance(np.inf, max_events=300)
        assert simulation.search == "cells"
        flown.append(simulation.positions)
    assert flown[0] == pytest.approx(flown[1], abs=1e-9)


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**31), st.sampled_from([2.0, 4.0, 12.0, 100.0, 1000.0]), st.sampled_from(["elastic", "reflect"]))
def test_mixed_sizes_never_come_to_overlap(seed, ratio, response):
    """A pair that was missed would be seen as an overlap."""
    rng = np.random.default_rng(seed)
    count = 150
    radii = np.where(rng.random(count) < 0.05, 0.5, 0.5 / ratio * rng.uniform(1, 2, count))
    radii[0] = 0.5
    half = np.array([1.0, 1.5, 2.5]) * max(1.0, 0.7 * (radii**3).sum() ** (1 / 3))
    kept: list[int] = []
    positions = rng.uniform(-1, 1, (count, 3)) * (half - radii[:, None])
    for k in np.argsort(-radii):
        if all(np.linalg.norm(positions[k] - positions[m]) > radii[k] + radii[m] for m in kept):
            kept.append(int(k))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(grids, "MOST_AROUND", 0.0)  # each size class has a grid, however few its spheres are
        simulation = Simulation(
            positions[kept], rng.normal(size=(len(kept), 3)), radii[kept], radii[kept] ** 3, half, response
        )
    for _ in range(20):
        simulation.advance(np.inf, max_events=150)
        x, r = simulation.positions, radii[kept]
        gaps = np.linalg.norm(x[:, None] - x[None], axis=2) - r[:, None] - r[None] + 10 * np.eye(len(r))
        assert gaps.min() > -1e-11


def test_the_width_of_cells_does_not_show(monkeypatch):
    """Many small spheres between large ones stand in wider cells than others."""
    rng = np.random.default_rng(11)
    radii, half = np.r_[np.full(4, 5.0), np.full(2100, 0.5)], np.full(3, 16.0)
    positions = add_at_random(radii, half, rng)
    velocities = rng.normal(size=(len(radii), 3)) / radii[:, None]
    events, cells = [], []
    for most in (grids.MIXED_CELLS_PER_SPHERE, grids.CELLS_PER_SPHERE):
        monkeypatch.setattr(grids, "MIXED_CELLS_PER_SPHERE", most)
        simulation = Simulation(positions, velocities, radii, radii**3, half, "elastic", record=True)
        simulation.advance(np.inf, max_events=3000)
        events.append(simulation.events)
        cells.append(simulation.counters["cell_crossings"])
    assert cells[0] < 0.8 * cells[1]
    for name in ("kind", "i", "j", "wall"):
        assert np.array_equal(events[0][name], events[1][name])
    assert np.abs(events[0]["time"] - events[1]["time"]).max() < 1e-11


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"radii": [0.5, -1]}, "positive"),
        ({"masses": [1]}, "shape"),
        ({"positions": [(0, 0, 0), (0, 0, np.nan)]}, "finite"),
        ({"response": "bounce"}, "one of"),
        ({"restitution": 1.5}, "between 0 and 1"),
        ({"search": "lists", "radii": [0.5, 0.01]}, "not possible"),
    ],
)
def test_wrong_input_is_refused(change, message):
    scene = {
        "positions": np.zeros((2, 3)),
        "velocities": np.zeros((2, 3)),
        "radii": [0.5, 0.5],
        "masses": [1, 1],
        "half_box": [2, 2, 2],
    }
    with pytest.raises(InputError, match=message):
        Simulation(**(scene | change))
