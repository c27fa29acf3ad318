"""How much work a broad phase does, in counters: they have no noise."""

import numpy as np
import pytest

from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.broadphase.uniform_grid import CELLS_PER_BODY, UniformGrid
from harness.scene.box import Box


def crowd(radii, packing, seed=259):
    """Positions uniform in a cube."""
    half = (4 / 3 * np.pi * (radii**3).sum() / packing) ** (1 / 3) / 2
    return np.random.default_rng(seed).uniform(-half, half, (len(radii), 3)), Box(np.full(3, half))


def work_of(method, radii, packing):
    positions, box = crowd(radii, packing)
    detector = method(radii, box)
    detector.close_pairs(positions)
    return detector.pair_tests


@pytest.mark.parametrize("packing", [0.001, 0.05, 0.2, 0.5])
@pytest.mark.parametrize("method", [UniformGrid, HierarchicalGrid])
def test_pair_tests_grow_with_the_number_of_bodies_and_not_its_square(method, packing):
    counts = np.array([1000, 8000, 64000])
    tests = [work_of(method, np.full(n, 0.5), packing) for n in counts]
    exponent = np.polyfit(np.log(counts), np.log(tests), 1)[0]
    assert exponent <= 1.05
    assert tests[-1] < 20 * counts[-1]


def test_pair_tests_count_all_frames_and_no_pair_twice():
    radii = np.full(300, 0.5)
    detector = UniformGrid(radii, Box(np.full(3, 0.1)))  # one cell: every pair is a candidate
    for frame in (1, 2, 3):
        detector.close_pairs(np.zeros((300, 3)))
        assert detector.pair_tests == frame * 300 * 299 // 2


@pytest.mark.parametrize("ratio", [10, 1000])
def test_a_few_large_bodies_among_many_small_ones_cost_less_than_twice_the_small_ones_alone(ratio):
    small = np.full(10_000, 0.5 / ratio)
    mixed = np.append(small, np.full(20, 0.5))
    tests = work_of(HierarchicalGrid, mixed, 0.05)
    assert tests < 2 * work_of(HierarchicalGrid, small, 0.05)
    assert tests < work_of(UniformGrid, mixed, 0.05) / 20


def test_a_mix_of_all_sizes_up_to_1000_to_1_needs_a_constant_number_of_tests_a_body():
    rng = np.random.default_rng(1)
    for count in (1000, 8000, 64000):
        radii = 0.5 * 1000 ** -rng.uniform(0, 1, count)
        assert work_of(HierarchicalGrid, radii, 0.05) < 12 * count


@pytest.mark.parametrize("method", [UniformGrid, HierarchicalGrid])
def test_with_equal_sizes_both_grids_do_the_same_tests(method):
    assert work_of(method, np.full(2000, 0.5), 0.1) == work_of(UniformGrid, np.full(2000, 0.5), 0.1)


@pytest.mark.parametrize("half", [(1e8, 1e8, 1e8), (1e8, 1e-8, 1e-8), (1e8, 1e8, 1e-8), (1e8, 1e3, 1.0)])
@pytest.mark.parametrize("method", [UniformGrid, HierarchicalGrid])
def test_huge_and_thin_boxes_have_few_cells_a_body_and_few_bodies_a_cell(method, half):
    rng = np.random.default_rng(2)
    positions = rng.uniform(-1, 1, (5000, 3)) * np.array(half)
    detector = method(np.full(5000, 1e-9), Box(np.array(half)))
    detector.close_pairs(positions)
    assert detector.cell_count <= CELLS_PER_BODY * 5000 + 8
    assert detector.pair_tests < 40 * 5000


def test_one_body_far_outside_does_not_thin_out_the_lattice():
    radii = np.full(5000, 0.5)
    positions, box = crowd(radii, 0.1)
    detector = UniformGrid(radii, box)
    detector.close_pairs(positions)
    usual = detector.pair_tests
    positions[17] = 1e12
    detector.close_pairs(positions)
    assert detector.pair_tests - usual < 1.1 * usual


def test_bodies_crowded_into_a_corner_of_the_box_get_cells_of_their_own_size():
    radii = np.full(5000, 0.5)
    positions, _ = crowd(radii, 0.1)
    detector = UniformGrid(radii, Box(np.full(3, 1e6)))
    detector.close_pairs(positions + 9e5)
    assert detector.pair_tests < 10 * 5000


@pytest.mark.parametrize("method", [UniformGrid, HierarchicalGrid])
@pytest.mark.parametrize("packing", [0.001, 0.05, 0.5])
def test_a_body_overlaps_at_most_eight_cells(method, packing):
    radii = np.random.default_rng(3).uniform(0.05, 0.5, 3000)
    for sizes in (radii, np.full(3000, 0.5)):
        positions, box = crowd(sizes, packing)
        detector = method(sizes, box)
        detector.close_pairs(positions)
        most, mean = detector.cells_per_body()
        assert most == 8
        assert 1 <= mean <= 8
