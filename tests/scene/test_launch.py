import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from harness.scene import random_packing
from harness.scene.box import Box
from harness.scene.lattice import sites
from harness.scene.launch import PlacementError, directions, orientations, place
from harness.scene.relaxation import overlapping
from tests.conftest import examples, slow_beyond


def box_for(radii, packing, shape=(1.0, 1.0, 1.0)):
    volume = 4 / 3 * np.pi * np.sum(radii**3) / packing
    return Box(np.array(shape) * np.cbrt(volume / np.prod(shape)) / 2)


def assert_placed(positions, radii, box):
    assert positions.shape == (len(radii), 3)
    assert (np.abs(positions) + radii[:, None] <= box.half * (1 + 1e-12)).all()
    assert len(overlapping(positions, radii * (1 - 1e-11))) == 0


radii_of_any_sizes = st.lists(st.floats(0.05, 1.0), min_size=0, max_size=60).map(np.array)


@given(radii_of_any_sizes, st.floats(0.001, 0.45), st.tuples(*[st.floats(0.3, 3)] * 3), st.integers(0, 99))
@settings(max_examples=examples(50), deadline=None)
def test_bodies_are_inside_and_apart_or_the_reason_is_said(radii, packing, shape, seed):
    box = box_for(radii, packing, shape) if len(radii) else Box(np.ones(3))
    try:
        positions = place(radii, box, np.random.default_rng(seed), overlap=False)
    except PlacementError:
        # only what cannot fit, or what chance cannot reach, may be refused
        wide = 2 * radii.max() / box.sides.min()
        assert wide > 1 or packing > 0.2 or (len(radii) < 10 and wide > 0.4)
    else:
        assert_placed(positions, radii, box)


@pytest.mark.parametrize("packing", slow_beyond([0.2, 0.49, 0.01, 0.3, 0.36, 0.6], 2))
def test_a_thousand_equal_bodies_are_placed_at_any_packing(packing):
    radii = np.full(1000, 0.5)
    box = box_for(radii, packing)
    assert_placed(place(radii, box, np.random.default_rng(1), overlap=False), radii, box)


@pytest.mark.slow
@pytest.mark.parametrize("packing", [0.3, 0.4, 0.5, 0.55])
def test_bodies_of_mixed_sizes_are_placed_where_chance_and_lattices_fail(packing):
    radii = np.random.default_rng(1).uniform(0.25, 0.75, 300)
    box = box_for(radii, packing)
    assert_placed(place(radii, box, np.random.default_rng(1), overlap=False), radii, box)


def test_a_thousandfold_ratio_of_sizes_is_no_special_case():
    radii = np.where(np.arange(20_000) % 1000 == 0, 1.0, 0.001)
    box = box_for(radii, 0.2)
    assert_placed(place(radii, box, np.random.default_rng(1), overlap=False), radii, box)


def test_many_bodies_at_a_packing_of_three_tenths():
    radii = np.full(20_000, 0.5)
    box = box_for(radii, 0.3)
    assert_placed(place(radii, box, np.random.default_rng(1), overlap=False), radii, box)


@pytest.mark.slow
def test_the_same_state_of_the_generator_gives_the_same_places():
    radii = np.random.default_rng(1).uniform(0.25, 0.75, 200)
    for packing in (0.2, 0.5):
        box = box_for(radii, packing)
        one, two = (place(radii, box, np.random.default_rng(7), overlap=False) for _ in range(2))
        assert np.array_equal(one, two)
        assert not np.array_equal(one, place(radii, box, np.random.default_rng(8), overlap=False))


@pytest.mark.parametrize("ratio", slow_beyond([3.0, 1.0, 10.0]))
@pytest.mark.parametrize("packing", [0.05, 0.29])
def test_without_a_kernel_a_few_bodies_are_put_to_the_same_places(packing, ratio, monkeypatch):
    for count in (1, 2, 40, 150):
        radii = np.sort(np.random.default_rng(count).uniform(1.0, ratio, count))[::-1].copy()
        half = np.maximum(box_for(radii, packing, (1.0, 1.0, 1.4)).half, radii[0])
        places = []
        for few in (0, random_packing.FEW):
            monkeypatch.setattr(random_packing, "FEW", few)
            rng = np.random.default_rng(7)
            places.append((random_packing.add_at_random(radii, half, rng).tobytes(), rng.random()))
        assert places[0] == places[1]


def test_eight_bodies_fill_a_box_of_two_diameters_exactly_and_a_ninth_finds_no_room():
    box = Box(np.ones(3))
    positions = place(np.full(8, 0.5), box, np.random.default_rng(1), overlap=False)
    assert np.array_equal(np.abs(positions), np.full((8, 3), 0.5))
    with pytest.raises(PlacementError, match=r"only 8 of 9 bodies .*packing 0\.524 of 0\.589.*overlap: allow"):
        place(np.full(9, 0.5), box, np.random.default_rng(1), overlap=False)


def test_a_body_as_large_as_the_box_is_in_its_middle():
    assert np.array_equal(place(np.ones(1), Box(np.ones(3)), np.random.default_rng(1), overlap=False), np.zeros((1, 3)))


@pytest.mark.parametrize(
    ("radii", "half", "reason"),
    [
        ([2.0], 1.0, "a body of diameter 4 m does not fit in a box of 2 x 2 x 2 m"),
        ([0.9, 0.7], 1.0, "overlap wherever they are"),
        ([0.5] * 20, 1.0, r"1\.31 times the volume"),
        ([0.5] * 12, 1.0, r"equal spheres fill at most 0\.740"),
    ],
)
def test_the_impossible_is_refused_at_once(radii, half, reason):
    with pytest.raises(PlacementError, match=reason):
        place(np.array(radii), Box(np.full(3, half)), np.random.default_rng(1), overlap=False)


def likelihood(values, *law):
    """The chance that values of a law are no more like it."""
    from scipy.stats import kstest  # which takes long to import

    return kstest(values, *law).pvalue


def test_where_overlap_is_allowed_only_the_box_limits():
    radii = np.full(5000, 0.5)
    box = Box(np.array([1.0, 1.0, 0.5]))
    positions = place(radii, box, np.random.default_rng(1), overlap=True)
    assert (np.abs(positions) <= [0.5, 0.5, 0]).all()
    assert likelihood(positions[:, 0], "uniform", (-0.5, 1)) > 1e-3
    with pytest.raises(PlacementError, match="does not fit"):
        place(np.full(1, 0.6), box, np.random.default_rng(1), overlap=True)


@pytest.mark.slow
@given(st.integers(1, 500), st.tuples(*[st.floats(0, 12)] * 3))
@settings(max_examples=80, deadline=None)
def test_lattice_sites_are_in_their_room_and_a_spacing_apart(count, sides):
    room = np.array(sides)
    found, spacing = sites(count, 1.0, room)
    assert (np.abs(found) <= room / 2 * (1 + 1e-12)).all()
    assert spacing >= 1
    if len(found) > 1:
        assert cKDTree(found).query(found, k=2)[0][:, 1].min() >= spacing * (1 - 1e-11)


def test_large_lattices_are_as_dense_as_spheres_can_be():
    found, _ = sites(10**9, 1.0, np.full(3, 60.0))  # more than fit: the most there are
    assert np.pi / 6 * len(found) / 61**3 > 0.96 * np.pi / np.sqrt(18)  # walls cost the rest


def test_directions_are_uniform_on_the_sphere():
    found = directions(np.random.default_rng(1), 20_000)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-15)
    for axis in range(3):  # Archimedes: heights are uniform along any axis
        assert likelihood(found[:, axis], "uniform", (-1, 2)) > 1e-3


def test_orientations_are_uniform_over_rotations():
    found = orientations(np.random.default_rng(1), 20_000)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-15)
    angle = 2 * np.arccos(np.abs(found[:, 0]))
    assert likelihood(angle, lambda t: (t - np.sin(t)) / np.pi) > 1e-3
    w, x, y, z = found.T
    turned = np.column_stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
    for axis in range(3):
        assert likelihood(turned[:, axis], "uniform", (-1, 2)) > 1e-3
