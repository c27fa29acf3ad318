"""Intervals of contact: closed forms, FCL at many instants, and what must hold whatever the motion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.narrowphase.contact_end import MOST_CREEPING, end_of_hull_contact, end_of_mesh_contact
from harness.narrowphase.contact_intervals import hull_contacts, mesh_contacts
from harness.narrowphase.free_flight import orientation, place
from harness.narrowphase.gjk import COLD_START, MARGIN, hull_distance, relative_pose
from harness.narrowphase.vectors import minus
from harness.narrowphase.verdicts import PairVerdict, SearchVerdict
from tests.narrowphase.flights import Truth, body, encounter, shape_named
from tests.narrowphase.meshes import MESHES, mesh_named

WIDTH = 1 / np.sqrt(3)


def of_meshes(name, a, b, end, begin=0.0, tolerance=1e-9):
    return mesh_contacts(shape_named(name), shape_named(name), a, b, begin, end, tolerance)


def of_hulls(name, a, b, end, begin=0.0, tolerance=1e-9):
    hull = shape_named(name).hull
    return hull_contacts(hull, hull, a, b, begin, end, tolerance)


@pytest.mark.slow
def test_cubes_that_fly_through_each_other_touch_from_face_to_face_until_they_are_apart():
    a, b = body(), body((5, 0.1, 0.07), (-2.0, 0, 0))
    expected = [[(5 - WIDTH) / 2, (5 + WIDTH) / 2]]
    for contacts in (of_meshes("cube", a, b, 9.0), of_hulls("cube", a, b, 9.0)):
        assert contacts.intervals == pytest.approx(np.array(expected), abs=2e-9)
        assert not contacts.stalled


def test_a_small_cube_inside_a_large_one_touches_its_surface_on_the_way_in_and_out_but_its_hull_all_the_way():
    small = 0.3
    a, b = body(), body((3, 0.05, 0.02), (-1.0, 0, 0), size=small)
    near, far = WIDTH * (1 - small) / 2, WIDTH * (1 + small) / 2
    surfaces, hulls = of_meshes("cube", a, b, 9.0), of_hulls("cube", a, b, 9.0)
    assert surfaces.intervals == pytest.approx(np.array([[3 - far, 3 - near], [3 + near, 3 + far]]), abs=2e-9)
    assert hulls.intervals == pytest.approx(np.array([[3 - far, 3 + far]]), abs=2e-9)


def test_a_window_cuts_a_contact_at_either_side():
    a, b = body(), body((5, 0.1, 0.07), (-2.0, 0, 0))
    for of in (of_meshes, of_hulls):
        assert of("cube", a, b, 2.6, begin=2.4).intervals.tolist() == [[2.4, 2.6]]
        assert len(of("cube", a, b, 2.0).intervals) == 0
        assert len(of("cube", a, b, 9.0, begin=3.0).intervals) == 0
        assert of("cube", a, b, 9.0, begin=2.5).intervals[0] == pytest.approx([2.5, (5 + WIDTH) / 2], abs=2e-9)


def test_a_spinning_bar_of_two_cubes_width_touches_a_wall_cube_twice_a_turn():
    rate, distance = 2.0, 0.65  # an edge of the spinning cube reaches .577 + ... only when it points at the other
    a, b = body(), body((distance, 0.01, 0.02), spin=(0, 0, rate))
    reach = distance - WIDTH / 2
    # reach of the spinning cube: w/2 (|cos| + |sin|) = w/sqrt2 cos(angle - 45 degrees)
    half = np.arccos(reach / (WIDTH / np.sqrt(2))) / rate
    quarter = np.pi / 2 / rate
    expected = [[quarter * (k + 0.5) - half, quarter * (k + 0.5) + half] for k in range(4)]
    for of in (of_meshes, of_hulls):
        assert of("cube", a, b, 4 * quarter).intervals == pytest.approx(np.array(expected), abs=1e-8)


@pytest.mark.slow
@settings(max_examples=25)
@given(st.integers(0, 10**6), st.sampled_from(MESHES), st.sampled_from([0.0, 3.0, 10.0]))
def test_surfaces_touch_at_every_instant_of_a_contact_and_at_none_between(seed, name, spin):
    a, b = encounter(seed, spin)
    tolerance = 1e-6
    contacts = of_meshes(name, a, b, 1.5, tolerance=tolerance)
    assert not contacts.stalled
    ends = contacts.intervals.ravel()
    assert (np.diff(ends) > 0).all()
    truth = Truth(mesh_named(name), a, b)
    for time in np.linspace(0, 1.5, 400):
        inside = np.searchsorted(ends, time) % 2 == 1
        if np.abs(ends - time).min(initial=np.inf) > 1e-5:
            if inside and not truth.touch(time):
                assert truth.distance(time) <= 1.25 * tolerance
            assert inside or not truth.touch(time)


@pytest.mark.slow
@settings(max_examples=25)
@given(st.integers(0, 10**6), st.sampled_from(["cube", *MESHES]), st.sampled_from([0.0, 3.0, 10.0]))
def test_hulls_overlap_at_every_instant_of_a_contact_and_at_none_between(seed, name, spin):
    a, b = encounter(seed, spin)
    contacts = of_hulls(name, a, b, 1.5, tolerance=1e-7)
    ends, hull = contacts.intervals.ravel(), shape_named(name).hull
    assert not contacts.stalled
    for time in np.linspace(0, 1.5, 400):
        if np.abs(ends - time).min(initial=np.inf) > 1e-6:
            pose = relative_pose(
                orientation(a, time), a.size, orientation(b, time), b.size, minus(place(b, time), place(a, time))
            )
            found = hull_distance(
                hull, hull, pose, COLD_START, (1.0, 0.0, 0.0), MARGIN * (a.size + b.size), np.inf, 0.0
            )
            inside = np.searchsorted(ends, time) % 2 == 1
            expected = PairVerdict.TOUCHING if inside else PairVerdict.SEPARATE
            assert found.verdict == expected or (inside and found.lower <= 1.25e-7)


def gap_of_hulls(hull, a, b, time):
    offset = minus(place(b, time), place(a, time))
    pose = relative_pose(orientation(a, time), a.size, orientation(b, time), b.size, offset)
    return hull_distance(hull, hull, pose, COLD_START, (1.0, 0.0, 0.0), MARGIN * (a.size + b.size), np.inf, 0.0).lower


def test_contacts_of_hulls_are_followed_in_few_steps_and_end_where_the_gap_is_just_wider_than_the_tolerance():
    # where they end, steps of what is left by the speed alone go on by a third each, down to the tolerance
    most_on_average = {0.0: 18, 3.0: 55, 30.0: 190}
    steps, hull = {spin: [] for spin in most_on_average}, shape_named("pumpkin-1753.ply").hull
    for seed in range(90):
        tolerance, spin = (1e-4, 1e-7, 1e-10)[seed % 3], (0.0, 3.0, 30.0)[seed // 3 % 3]
        a, b = encounter(seed, spin)
        contacts = hull_contacts(hull, hull, a, b, 0.0, 3.0, tolerance)
        for begin, end in contacts.intervals[contacts.intervals[:, 1] < 3.0]:
            ended = end_of_hull_contact(hull, hull, a, b, begin, 3.0, tolerance)
            steps[spin].append(ended.steps)
            assert (ended.verdict, ended.time) == (SearchVerdict.FOUND, end)
            rounding = 4.0 * MARGIN + 1e-15 * (1.0 + np.abs(a.spin).max())
            assert 1.125 * tolerance - rounding <= gap_of_hulls(hull, a, b, end) <= 1.25 * tolerance + rounding
            for before in np.geomspace(1e-14, end - begin, 60):
                assert gap_of_hulls(hull, a, b, end - before) <= 1.25 * tolerance + rounding
    for spin, most in most_on_average.items():
        assert len(steps[spin]) > 20
        assert np.mean(steps[spin]) < most


@pytest.mark.slow
@settings(max_examples=15)
@given(st.integers(0, 10**6), st.sampled_from(MESHES))
def test_surfaces_touch_only_while_their_hulls_do(seed, name):
    a, b = encounter(seed, 3.0)
    surfaces, hulls = (of(name, a, b, 1.5).intervals.ravel() for of in (of_meshes, of_hulls))
    for begin, end in surfaces.reshape(-1, 2):
        around = np.searchsorted(hulls, 0.5 * (begin + end))
        assert around % 2 == 1
        assert hulls[around - 1] <= begin + 1e-7
        assert end <= hulls[around] + 1e-7


def test_the_end_of_a_contact_is_where_the_gap_is_the_tolerance():
    a, b = body(), body((5, 0.1, 0.07), (-2.0, 0, 0))
    shape = shape_named("cube")
    for tolerance in (1e-2, 1e-4, 1e-6):
        ended = end_of_mesh_contact(shape, shape, a, b, 2.5, 9.0, tolerance)
        gap = 2 * ended.time - 5 - WIDTH
        assert ended.verdict == SearchVerdict.FOUND
        assert 1.12 * tolerance <= gap <= 1.26 * tolerance


def test_a_contact_is_followed_where_the_first_crossing_that_is_found_is_over_at_once():
    # of many launched at random the pair whose first two triangles cross by less than is proved to last
    shape = shape_named("pumpkin-1753.ply")
    a = body(
        (9.698130943319692, -5.789900946238779, -8.343332438782694),
        (1.0550675538828989, 0.11609573366660553, -0.23893639765575184),
        (-0.3747730647102604, -0.45118834591720597, 0.8032780365509786, -0.1035307803070142),
        (2.443816840928261, 0.40214042503331543, -0.26864649518044803),
    )
    b = body(
        (9.004683244761754, -5.425233482210154, -8.791806656972888),
        (0.49115328385810814, -0.8339614502343027, -0.6197970116289894),
        (0.5038719178685125, 0.6686266967345621, -0.22640062454904542, -0.4977893008102293),
        (-0.7606784241603627, 0.45776586173193884, -0.07211122459247195),
    )
    ended = end_of_mesh_contact(shape, shape, a, b, 0.0, 0.5, 1e-10)
    assert ended.verdict != SearchVerdict.STALLED
    assert ended.steps < 500


def test_faces_that_slide_over_each_other_are_followed_for_a_bounded_number_of_steps():
    # nothing but their gap, which stays 0, shows that they touch, and it proves no more than a step at a time
    shape, a, b = shape_named("cube"), body(), body((0.1, WIDTH, 0.05), (0.2, 0.0, 0.0))
    for ended in (
        end_of_hull_contact(shape.hull, shape.hull, a, b, 0.0, 9.0, 1e-9),
        end_of_mesh_contact(shape, shape, a, b, 0.0, 9.0, 1e-9),
    ):
        assert ended.verdict == SearchVerdict.STALLED
        assert ended.steps <= MOST_CREEPING
        assert 0.0 < ended.time < 5.0 * WIDTH - 0.5  # when they come apart


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9])
def test_hulls_that_slide_a_little_inside_each_other_are_followed_in_few_steps(depth):
    # which way they move shows that they go on to overlap; how fast would prove no more than a step of the depth
    cube = shape_named("cube").hull
    a, b = body(), body((0.1, WIDTH - depth, 0.05), (0.2, 0.0, 0.0))
    ended = end_of_hull_contact(cube, cube, a, b, 0.0, 9.0, 1e-10)
    assert ended.verdict == SearchVerdict.FOUND
    assert ended.time == pytest.approx(5.0 * (WIDTH - 0.1), abs=1e-8)
    assert ended.steps < 100
