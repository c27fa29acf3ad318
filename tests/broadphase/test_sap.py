"""Sweep and prune finds what brute force finds, to the bit, in any motion, and tests what overlaps along one axis."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.broadphase.sap import LANES, SweepAndPrune
from harness.scene.box import Box
from tests.broadphase.every_pair import touching_pairs
from tests.conftest import examples, slow_beyond

PLACES = ("inside", "near", "wall", "corner", "outside", "coincident", "touching", "lattice", "plane")
MOTIONS = ("rest", "drift", "leap", "anew", "mirror", "flatten", "collapse", "shift", "leave")


def assert_exact(detector, positions):
    pairs = detector.close_pairs(positions)
    assert pairs.dtype == np.int64
    assert np.array_equal(pairs, touching_pairs(positions, detector.radii))


def crowd(radii, packing, seed=259, shape=(1.0, 1.0, 1.0)):
    """Positions uniform in a box whose sides are in these ratios."""
    sides = np.array(shape) * (4 / 3 * np.pi * (radii**3).sum() / packing / np.prod(shape)) ** (1 / 3)
    return np.random.default_rng(seed).uniform(-1, 1, (len(radii), 3)) * sides / 2, Box(sides / 2)


def pairs_overlapping(positions, radii, axis):
    """How many pairs of bodies overlap along an axis, from the definition."""
    apart = np.abs(positions[:, None, axis] - positions[None, :, axis])
    return int(np.triu(apart <= radii[:, None] + radii[None], 1).sum())


@st.composite
def scenes(draw):
    """Bodies inside, on walls, in corners, far outside, on top of each other and just touching, of any sizes."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(0, 3 * LANES))
    scale = draw(st.sampled_from([1e-6, 1.0, 1e6]))
    ratio = draw(st.sampled_from([1.0, 2.0, 100.0, 1e3, 1e9]))
    radii = 0.5 * scale * ratio ** -rng.uniform(0, 1, n)
    if draw(st.booleans()):
        radii = np.where(rng.uniform(size=n) < 0.1, 0.5 * scale, 0.5 * scale / ratio)
    half = scale * np.array([draw(st.sampled_from([0.01, 0.5, 1.0, 3.0, 10.0, 1e8])) for _ in range(3)])
    centre = scale * draw(st.sampled_from([0.0, 0.0, 1.0, 1e8])) * rng.normal(size=3)
    positions = rng.uniform(-1, 1, (n, 3)) * half
    places = draw(st.lists(st.sampled_from(PLACES), min_size=1, unique=True))
    for i in range(n):
        kind, other, axis = rng.choice(places), rng.integers(n), rng.integers(3)
        reach = radii[i] + radii[other]
        if kind == "near":
            positions[i] = positions[other] + rng.normal(size=3) * reach
        elif kind == "wall":
            positions[i, axis] = half[axis] * rng.choice([-1, 1])
        elif kind == "corner":
            positions[i] = half * rng.choice([-1, 1], 3)
        elif kind == "outside":
            positions[i] = half * rng.uniform(-3, 3, 3) * rng.choice([1, 1e3, 1e30])
        elif kind == "coincident":
            positions[i] = positions[other]
        elif kind == "touching":
            direction = rng.normal(size=3) if rng.uniform() < 0.5 else np.eye(3)[axis] * rng.choice([-1, 1])
            direction /= np.linalg.norm(direction)
            nudge = rng.choice([0, 1e-16, -1e-16, 1e-9, -1e-9])
            positions[i] = positions[other] + direction * reach * (1 + nudge)
        elif kind == "lattice":
            positions[i] = np.round(positions[i] / scale) * scale
        elif kind == "plane":
            positions[i, axis] = positions[other, axis]
    return positions + centre, radii, half


@pytest.mark.slow
@settings(max_examples=300)
@given(scenes())
def test_it_finds_exactly_what_brute_force_finds(scene):
    positions, radii, half = scene
    assert_exact(SweepAndPrune(radii, Box(half)), positions)


def moved(kind, positions, half, rng):
    """The next frame: a small motion, or one that makes the order or the axis of the last frame worthless."""
    if kind == "drift":
        return positions + rng.normal(size=positions.shape) * half * 0.003
    if kind == "leap":
        return positions + rng.normal(size=positions.shape) * half * 0.3
    if kind == "anew":
        return rng.uniform(-1, 1, positions.shape) * half
    if kind == "mirror":
        return -positions[:, ::-1]
    if kind == "flatten":
        return positions * np.where(np.arange(3) == rng.integers(3), 1e-9, 1.0)
    if kind == "collapse":
        return np.zeros_like(positions) + positions.mean(axis=0)
    if kind == "shift":
        return positions + half * rng.uniform(-1, 1, 3)
    if kind == "leave":
        return positions * np.where(rng.uniform(size=(len(positions), 1)) < 0.05, 1e6, 1.0)
    return positions


@settings(max_examples=examples(100))
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 300),
    st.sampled_from([1.0, 3.0, 100.0, 1000.0]),
    st.sampled_from([0.02, 0.2, 0.6]),
    st.lists(st.sampled_from(MOTIONS), min_size=1, max_size=12),
)
def test_it_stays_exact_in_any_motion_since_nothing_of_a_frame_but_the_order_outlives_it(
    seed, count, ratio, packing, motions
):
    rng = np.random.default_rng(seed)
    radii = 0.5 * ratio ** -rng.uniform(0, 1, count)
    positions, box = crowd(radii, packing, seed, shape=(1.0, rng.uniform(0.2, 1), rng.uniform(1, 5)))
    detector = SweepAndPrune(radii, box)
    assert_exact(detector, positions)
    for kind in motions:
        positions = moved(kind, positions, box.half, rng)
        assert_exact(detector, positions)


@pytest.mark.parametrize("count", range(5))
@pytest.mark.parametrize("place", [0.0, 0.3, 1e12, 1e150])
def test_no_body_one_and_a_few_in_the_same_place_are_found_in_every_frame(count, place):
    detector = SweepAndPrune(np.ones(count), Box(np.ones(3)))
    for _ in range(3):
        pairs = detector.close_pairs(np.full((count, 3), place))
        assert np.array_equal(pairs, np.stack(np.triu_indices(count, 1), axis=1))


@pytest.mark.slow
def test_two_thousand_bodies_in_one_place_are_two_million_pairs():
    detector = SweepAndPrune(np.full(2000, 0.5), Box(np.ones(3)))
    expected = np.stack(np.triu_indices(2000, 1), axis=1)
    for _ in range(2):  # with the first frame's room, and with its own
        assert np.array_equal(detector.close_pairs(np.full((2000, 3), 0.25)), expected)


@pytest.mark.parametrize("centre", [0.0, 1e3, 1e8, 1e15, 1e17])
@pytest.mark.parametrize("ratio", [1.0, 1000.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_contact_to_the_last_bit_is_decided_alike_however_far_from_the_origin(axis, ratio, centre):
    rng = np.random.default_rng(7)
    half = np.full(3, 1e-3)
    half[axis] = 1000.0
    radii = np.where(rng.uniform(size=600) < 0.5, 0.5, 0.5 / ratio)
    positions = rng.uniform(-1, 1, (600, 3)) * half
    positions[:, axis] += centre
    reach = radii[::2] + radii[1::2]
    positions[1::2] = positions[::2]
    positions[1::2, axis] += reach * rng.choice([-1, 1], 300)
    positions[1::4, axis] = np.nextafter(positions[1::4, axis], np.inf)
    assert_exact(SweepAndPrune(radii, Box(half)), positions)


@pytest.mark.parametrize("size", [1e-150, 1e-6, 1e6, 1e150])
def test_the_smallest_and_the_largest_sizes_neither_vanish_nor_overflow(size):
    positions = np.array([[0, 0, 0], [2 * size, 0, 0], [0, 2.5 * size, 0], [0, 0, 0]]) / (1 if size < 1e100 else 4)
    assert_exact(SweepAndPrune(np.full(4, size), Box(np.full(3, 3 * size))), positions)


def test_sizes_from_the_smallest_to_the_largest_in_one_scene_are_found():
    radii = np.logspace(-150, 149, 300)
    positions = np.zeros((300, 3))
    positions[:, 0] = np.append(radii[1:], 0) * (1 + 1e-12)
    assert_exact(SweepAndPrune(radii, Box(np.ones(3))), positions)


def test_bodies_that_all_left_the_box_are_still_found():
    positions = np.array([[1e9, 0, 0], [1e9, 0.5, 0], [-1e9, 0, 0], [-1e9, 0, 0.9], [5, 5, 5]], float)
    detector = SweepAndPrune(np.full(5, 0.5), Box(np.ones(3)))
    assert detector.close_pairs(positions).tolist() == [[0, 1], [2, 3]]
    assert len(detector.close_pairs(positions + 1e10)) == 2


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1.7e308])
def test_positions_that_are_no_places_are_refused_and_harm_nothing(bad):
    rng = np.random.default_rng(3)
    radii = np.full(50, 0.2)
    positions = rng.uniform(-1, 1, (50, 3))
    detector = SweepAndPrune(radii, Box(np.ones(3)))
    for axis in range(3):
        broken = positions.copy()
        broken[rng.integers(50), axis] = bad
        with pytest.raises(ValueError, match="finite"):
            detector.close_pairs(broken)
    assert detector.pair_tests == 0
    assert_exact(detector, positions)


def test_wrong_shapes_and_radii_are_refused():
    box = Box(np.ones(3))
    with pytest.raises(ValueError, match="shape"):
        SweepAndPrune(np.ones(3), box).close_pairs(np.zeros((4, 3)))
    with pytest.raises(ValueError, match="shape"):
        SweepAndPrune(np.ones((3, 1)), box)
    for bad in (0.0, -1.0, np.nan, np.inf, 1e200):
        with pytest.raises(ValueError, match="radii"):
            SweepAndPrune([1.0, bad], box)


def test_any_layout_and_number_type_of_the_same_positions_gives_the_same_pairs():
    rng = np.random.default_rng(11)
    positions = rng.uniform(-1, 1, (200, 3)).astype(np.float32).astype(np.float64)
    detector = SweepAndPrune(np.full(200, 0.2), Box(np.ones(3)))
    expected = touching_pairs(positions, detector.radii)
    frozen = positions.copy()
    frozen.setflags(write=False)
    for same in (positions.tolist(), positions.astype(np.float32), np.asfortranarray(positions), frozen):
        assert np.array_equal(detector.close_pairs(same), expected)


def test_returned_pairs_and_given_arrays_belong_to_the_caller():
    rng = np.random.default_rng(13)
    positions = rng.uniform(-1, 1, (100, 3))
    before = positions.copy()
    detector = SweepAndPrune(np.full(100, 0.3), Box(np.ones(3)))
    first = detector.close_pairs(positions)
    kept = first.copy()
    detector.close_pairs(-positions / 2)
    assert np.array_equal(first, kept)
    assert np.array_equal(positions, before)


def test_what_it_keeps_grows_with_the_bodies_and_the_close_pairs_alone():
    def kept(detector):
        return sum(value.nbytes for value in vars(detector).values() if isinstance(value, np.ndarray))

    for count in (100, 1000, 10_000):
        detector = SweepAndPrune(np.full(count, 0.5), Box(np.ones(3)))
        for packing in (0.5, 0.05):
            pairs = detector.close_pairs(crowd(detector.radii, packing)[0])
            assert kept(detector) <= 1000 + 80 * count + 12 * max(len(pairs), 2 * count)


@pytest.mark.parametrize("ratio", [1.0, 10.0, 1000.0])
def test_the_pairs_tested_are_those_that_overlap_along_the_axis_with_the_fewest(ratio):
    rng = np.random.default_rng(23)
    radii = 0.5 * ratio ** -rng.uniform(0, 1, 700)
    for shape in ((1, 1, 1), (3, 1, 1), (1, 3, 2), (1, 1, 9)):
        positions, box = crowd(radii, 0.1, shape=shape)
        overlaps = [pairs_overlapping(positions, radii, axis) for axis in range(3)]
        detector = SweepAndPrune(radii, box)
        for frame in (1, 2, 3):  # all frames count, and no pair counts twice in one
            detector.close_pairs(positions)
            assert detector.pair_tests == frame * min(overlaps)


def test_pairs_of_equal_places_are_tested_once_each():
    positions = np.repeat(np.arange(30.0), 10)[:, None] * [1.0, 0.0, 0.0]
    detector = SweepAndPrune(np.full(300, 0.25), Box(np.full(3, 15.0)))
    detector.close_pairs(positions[np.random.default_rng(1).permutation(300)])
    assert detector.pair_tests == 30 * 45


@pytest.mark.parametrize("packing", slow_beyond([0.3, 0.05]))
def test_pair_tests_grow_with_the_power_five_thirds_in_a_cube_and_linearly_in_a_tube(packing):
    def exponent(shape):
        tests = []
        for count in counts:
            positions, box = crowd(np.full(count, 0.5), packing, shape=shape(count))
            detector = SweepAndPrune(np.full(count, 0.5), box)
            detector.close_pairs(positions)
            tests.append(detector.pair_tests)
        return np.polyfit(np.log(counts), np.log(tests), 1)[0]

    counts = np.array([1000, 8000, 64000])
    assert exponent(lambda count: (1.0, 1.0, 1.0)) == pytest.approx(5 / 3, abs=0.03)
    assert exponent(lambda count: (1.0, count / 100, 1.0)) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("ratio", [100, 1000])
def test_large_bodies_do_not_make_small_ones_test_more_of_each_other(ratio):
    few, many = 20, 10_000
    radii = np.append(np.full(few, 0.5), np.full(many, 0.5 / ratio))
    positions, box = crowd(radii, 0.05)
    mixed, small = SweepAndPrune(radii, box), SweepAndPrune(radii[few:], box)
    mixed.close_pairs(positions)
    small.close_pairs(positions[few:])
    assert mixed.pair_tests <= small.pair_tests + few * (few + many)
    # Did all bodies look as far as the largest, a sixth of the box, each would meet a sixth of the others.
    assert mixed.pair_tests < many * many / 200


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [100, 1000])
@pytest.mark.parametrize("packing", [0.05, 0.3])
def test_one_large_body_in_a_hundred_takes_a_tenth_of_the_tests_of_equal_bodies_as_densely_packed(ratio, packing):
    def tests_of(radii):
        positions, box = crowd(radii, packing)
        detector = SweepAndPrune(radii, box)
        assert_exact(detector, positions)
        return detector.pair_tests

    # the ratio, 0.09 and 0.05, is the same from 2000 bodies to 10 000; all pairs are looked at to know the answer
    mixed = np.where(np.arange(3000) % 100 == 0, 0.5, 0.5 / ratio)
    assert tests_of(mixed) < tests_of(np.full(3000, 0.5)) / 10


def test_a_slow_motion_is_sorted_by_moving_a_few_and_a_wild_one_anew():
    radii = np.full(1000, 0.5)
    positions, box = crowd(radii, 0.3)
    velocities = np.random.default_rng(5).normal(size=positions.shape)
    slow, wild = SweepAndPrune(radii, box), SweepAndPrune(radii, box)
    for frame in range(6):
        assert_exact(slow, positions + frame / 60 * velocities)
        assert_exact(wild, np.random.default_rng(frame).permutation(positions))
    assert slow.full_sorts == 1  # in the first frame there is no order to keep
    assert wild.full_sorts == 6


def test_another_axis_is_swept_once_bodies_crowd_along_the_first():
    radii = np.full(1000, 0.5)
    positions, box = crowd(radii, 0.1, shape=(1, 1, 1.2))
    detector = SweepAndPrune(radii, box)
    detector.close_pairs(positions)
    flat = positions * [1.0, 1.0, 1e-3]  # along z all overlap
    detector.close_pairs(flat)
    before = detector.pair_tests
    assert_exact(detector, flat)
    assert detector.pair_tests - before == min(pairs_overlapping(flat, radii, axis) for axis in range(2))


@pytest.mark.slow
def test_one_body_far_outside_costs_nothing():
    radii = np.full(3000, 0.5)
    positions, box = crowd(radii, 0.1)
    usual = SweepAndPrune(radii, box)
    usual.close_pairs(positions)
    positions[17] = 1e12
    detector = SweepAndPrune(radii, box)
    assert_exact(detector, positions)
    assert detector.pair_tests <= usual.pair_tests
