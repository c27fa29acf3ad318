"""Every broad phase returns the same pairs as a plain numpy reference, on every scene."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.broadphase.cell_order import MOST_BUCKETS, SMALLEST_BUCKET
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.broadphase.pairs import BroadPhase
from harness.broadphase.sap import SweepAndPrune
from harness.broadphase.uniform_grid import UniformGrid
from harness.scene.box import Box
from tests.broadphase.every_pair import touching_pairs
from tests.conftest import slow_beyond

METHODS = ("grid", "hierarchical grid")
PLACES = ("inside", "near", "wall", "corner", "outside", "coincident", "touching", "lattice")


def make(method, radii, half=(1.0, 1.0, 1.0)) -> BroadPhase:
    box = Box(np.array(half, float))
    return {
        "grid": lambda: UniformGrid(radii, box),
        "hierarchical grid": lambda: HierarchicalGrid(radii, box),
    }[method]()


def assert_exact(positions, radii, half=(1.0, 1.0, 1.0)):
    expected = touching_pairs(positions, radii)
    for method in METHODS:
        pairs = make(method, radii, half).close_pairs(positions)
        assert pairs.dtype == np.int64
        assert np.array_equal(pairs, expected.reshape(-1, 2)), method


@st.composite
def scenes(draw):
    """Bodies inside, on walls, in corners, far outside, on top of each other and just touching, of any sizes."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(0, 60))
    scale = draw(st.sampled_from([1e-6, 1.0, 1e6]))
    ratio = draw(st.sampled_from([1.0, 2.0, 10.0, 1e3, 1e9]))
    radii = scale * 0.5 * ratio ** -rng.uniform(0, 1, n)
    if draw(st.booleans()) and ratio > 1:
        radii = np.where(rng.uniform(size=n) < 0.2, 0.5 * scale, 0.5 * scale / ratio)
    half = scale * np.array([draw(st.sampled_from([0.01, 0.5, 1.0, 3.0, 10.0, 1e8])) for _ in range(3)])
    positions = rng.uniform(-1, 1, (n, 3)) * half
    for i in range(n):
        kind = draw(
            st.sampled_from(["inside", "near", "wall", "corner", "outside", "coincident", "touching", "lattice"])
        )
        other = rng.integers(n)
        if kind == "near":
            positions[i] = positions[other] + rng.normal(size=3) * (radii[i] + radii[other])
        elif kind == "wall":
            axis = rng.integers(3)
            positions[i, axis] = half[axis] * rng.choice([-1, 1])
        elif kind == "corner":
            positions[i] = half * rng.choice([-1, 1], 3)
        elif kind == "outside":
            positions[i] = half * rng.uniform(-3, 3, 3) * rng.choice([1, 1e3])
        elif kind == "coincident":
            positions[i] = positions[other]
        elif kind == "touching":
            direction = rng.normal(size=3) if rng.uniform() < 0.5 else np.eye(3)[rng.integers(3)]
            direction /= np.linalg.norm(direction)
            nudge = rng.choice([0, 1e-16, -1e-16, 1e-9, -1e-9])
            positions[i] = positions[other] + direction * (radii[i] + radii[other]) * (1 + nudge)
        elif kind == "lattice":
            positions[i] = np.round(positions[i] / scale) * scale
    return positions, radii, half


@pytest.mark.slow
@settings(max_examples=400, deadline=None)
@given(scenes())
def test_every_method_finds_exactly_what_the_definition_says(scene):
    assert_exact(*scene)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 3.0, 30.0, 1000.0]), st.sampled_from([0.02, 0.2, 0.6]))
def test_crowds_of_any_mix_are_found_exactly_frame_after_frame(seed, ratio, packing):
    rng = np.random.default_rng(seed)
    radii = 0.5 * ratio ** -rng.uniform(0, 1, 500)
    side = (4 / 3 * np.pi * (radii**3).sum() / packing) ** (1 / 3)
    half = side / 2 * np.array([1.0, rng.uniform(0.2, 1), rng.uniform(1, 5)])
    methods = [make(method, radii, half) for method in METHODS]
    for spread in (1.0, 0.1, 1.5, 1.0):  # the same objects: nothing is left over from another frame
        positions = rng.uniform(-1, 1, (500, 3)) * half * spread
        expected = touching_pairs(positions, radii)
        for method in methods:
            assert np.array_equal(method.close_pairs(positions), expected)


@pytest.mark.parametrize("half", [(1e8, 1e8, 1e8), (1e8, 0.5, 0.5), (0.5, 0.5, 0.5), (1e-3, 1e3, 1e3)])
@pytest.mark.parametrize("ratio", [1.0, 1000.0])
def test_contact_to_the_last_bit_is_decided_alike_anywhere_in_thin_and_huge_boxes(half, ratio):
    rng = np.random.default_rng(7)
    radii = np.where(rng.uniform(size=400) < 0.5, 0.5, 0.5 / ratio)
    positions = rng.uniform(-1, 1, (400, 3)) * np.array(half)
    for i in range(0, 400, 2):
        axis = rng.integers(3)
        positions[i + 1] = positions[i]
        positions[i + 1, axis] += radii[i] + radii[i + 1]
        if i % 4:
            positions[i + 1, axis] = np.nextafter(positions[i + 1, axis], np.inf)
    assert_exact(positions, radii, half)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("count", [0, 1])
def test_nobody_and_one_body_have_no_pairs(method, count):
    assert make(method, np.ones(count)).close_pairs(np.zeros((count, 3))).shape == (0, 2)


@pytest.mark.parametrize("method", slow_beyond(METHODS))
def test_two_thousand_bodies_in_one_place_are_two_million_pairs(method):
    radii = np.full(2000, 0.5)
    detector = make(method, radii)
    expected = np.stack(np.triu_indices(2000, 1), axis=1)
    for _ in range(2):  # with the first frame's room, and with its own
        assert np.array_equal(detector.close_pairs(np.full((2000, 3), 0.25)), expected)


@pytest.mark.parametrize("ratio", slow_beyond([4.0, 1.0]))
def test_more_cells_than_the_smallest_buckets_hold_are_sorted_as_well(ratio):
    rng = np.random.default_rng(23)
    radii = rng.choice([0.5, 0.5 / ratio], 300_000)
    half = np.full(3, 90.0)
    positions = rng.uniform(-1, 1, (300_000, 3)) * half
    grid = make("hierarchical grid", radii, half)
    pairs = grid.close_pairs(positions)
    assert grid.cell_count > MOST_BUCKETS << SMALLEST_BUCKET
    assert np.array_equal(pairs, SweepAndPrune(radii, Box(half)).close_pairs(positions))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [1e-150, 1e-6, 1e6, 1e150])
def test_the_smallest_and_the_largest_sizes_neither_vanish_nor_overflow(method, size):
    positions = np.array([[0, 0, 0], [2 * size, 0, 0], [0, 2.5 * size, 0]]) / (1 if size < 1e100 else 4)
    pairs = make(method, np.full(3, size), np.full(3, 3 * size)).close_pairs(positions)
    assert np.array_equal(pairs, touching_pairs(positions, np.full(3, size)))


@pytest.mark.parametrize("method", METHODS)
def test_bodies_that_all_left_the_box_are_still_found(method):
    positions = np.array([[1e9, 0, 0], [1e9, 0.5, 0], [-1e9, 0, 0], [-1e9, 0, 0.9], [5, 5, 5]], float)
    assert make(method, np.full(5, 0.5)).close_pairs(positions).tolist() == [[0, 1], [2, 3]]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1.7e308])
def test_positions_that_are_no_places_are_refused_and_harm_nothing(method, bad):
    rng = np.random.default_rng(3)
    radii = np.full(50, 0.2)
    positions = rng.uniform(-1, 1, (50, 3))
    detector = make(method, radii)
    for axis in range(3):
        broken = positions.copy()
        broken[rng.integers(50), axis] = bad
        with pytest.raises(ValueError, match="finite"):
            detector.close_pairs(broken)
    assert np.array_equal(detector.close_pairs(positions), touching_pairs(positions, radii))


@pytest.mark.parametrize("method", METHODS)
def test_wrong_shapes_and_radii_are_refused(method):
    with pytest.raises(ValueError, match="shape"):
        make(method, np.ones(3)).close_pairs(np.zeros((4, 3)))
    with pytest.raises(ValueError, match="shape"):
        make(method, np.ones((3, 1)))
    for bad in (0.0, -1.0, np.nan, np.inf, 1e200):
        with pytest.raises(ValueError, match="radii"):
            make(method, [1.0, bad])


@pytest.mark.parametrize("method", METHODS)
def test_any_layout_and_number_type_of_the_same_positions_gives_the_same_pairs(method):
    rng = np.random.default_rng(11)
    positions = rng.uniform(-1, 1, (200, 3)).astype(np.float32).astype(np.float64)
    detector = make(method, np.full(200, 0.2))
    expected = touching_pairs(positions, np.full(200, 0.2))
    frozen = positions.copy()
    frozen.setflags(write=False)
    strided = np.zeros((400, 6))
    strided[::2, ::2] = positions
    for same in (
        positions.tolist(),
        positions.astype(np.float32),
        positions.astype(">f8"),
        np.asfortranarray(positions),
        strided[::2, ::2],
        frozen,
    ):
        assert np.array_equal(detector.close_pairs(same), expected)
    assert len(detector.close_pairs(np.round(positions).astype(int))) > 0


def test_returned_pairs_and_given_arrays_belong_to_the_caller():
    rng = np.random.default_rng(13)
    radii, positions = np.full(100, 0.3), rng.uniform(-1, 1, (100, 3))
    before = positions.copy()
    for method in METHODS:
        detector = make(method, radii)
        first = detector.close_pairs(positions)
        kept = first.copy()
        detector.close_pairs(-positions / 2)
        assert np.array_equal(first, kept)
        assert np.array_equal(positions, before)


def last_touching(x, reach):
    """The largest float that touches x, going up."""
    y = x + reach
    while np.sqrt((y - x) * (y - x)) <= reach:
        y = np.nextafter(y, np.inf)
    while np.sqrt((y - x) * (y - x)) > reach:
        y = np.nextafter(y, -np.inf)
    return y


@pytest.mark.slow
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("size", [0.1, 0.3, 0.7])
def test_a_pair_that_spans_a_whole_cell_to_the_last_bit_is_not_lost_to_rounding(axis, size):
    cells = 3000
    half = np.full(3, 1e-3)
    half[axis] = size * cells / 2
    positions = np.zeros((2 * cells // 3 + 2, 3))
    positions[-2:, axis] = -half[axis], half[axis]  # the lattice has this length
    for pair in range(cells // 3 - 1):
        x = np.nextafter(size * (3 * pair + 1) - half[axis], -np.inf)  # were cells of this size, the last place in one
        positions[2 * pair : 2 * pair + 2, axis] = x, last_touching(x, size)
    radii = np.full(len(positions), size / 2)
    assert len(touching_pairs(positions, radii)) >= cells // 3 - 1
    assert_exact(positions, radii, half)


@pytest.mark.slow
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("ratio", [1.0, 2.9, 10.0, 1000.0])
def test_touching_pairs_of_any_ratio_are_found_wherever_cells_end(axis, ratio):
    rng = np.random.default_rng(17)
    half = np.full(3, 1e-3)
    half[axis] = 1000.0
    positions = np.zeros((3000, 3))
    radii = np.where(np.arange(3000) % 2, 0.5, 0.5 / ratio)
    positions[::2, axis] = rng.uniform(-1000, 1000, 1500)
    positions[1::2, axis] = positions[::2, axis] + rng.choice([-1, 1], 1500) * (0.5 + 0.5 / ratio) * (1 - 1e-12)
    assert_exact(positions, radii, half)


@pytest.mark.parametrize("ratio", slow_beyond([10.0, 100.0]))
def test_many_small_bodies_all_over_a_few_large_ones_are_found(ratio):
    rng = np.random.default_rng(19)
    radii = np.append(np.full(20, 0.5), np.full(2000, 0.5 / ratio))
    directions = np.vstack([np.repeat([np.eye(3), -np.eye(3)], 100, axis=1).reshape(-1, 3), rng.normal(size=(1400, 3))])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    centres = rng.uniform(-5, 5, (20, 3))
    touching = centres[rng.integers(20, size=2000)] + directions * 0.5 * (1 + 1 / ratio) * (1 - 1e-12)
    assert_exact(np.vstack([centres, touching]), radii, (5.0, 5.0, 5.0))
