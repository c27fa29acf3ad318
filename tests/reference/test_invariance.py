"""Checks of invariance: exact on methods that keep a symmetry, and as large as it is broken on those that do not."""

from dataclasses import replace

import numpy as np
import pytest

from harness.motion.finite import NotFiniteError, require_finite_state
from harness.motion.hits import Trace
from harness.reference.invariance import CHECKS, invariance
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import make_bodies, random_scene

SYMMETRIES = ("reversal_error", "relabelling_error", "mirror_error", "scaling_error")


def straight(bend=lambda scene, positions: positions):
    """A method that flies all bodies straight ahead for two seconds, then bends where they are."""

    def fly(scene, slower):
        time = 2.0 * slower
        positions = scene.bodies.positions + scene.bodies.velocities * time
        none = np.empty(0, np.int64)
        return Trace(np.empty(0), np.empty((0, 2), np.int64), none, time, bend(scene, positions),
                     scene.bodies.velocities, 0.0, {})  # fmt: skip

    return fly


def scene():
    rng = np.random.default_rng(2)
    bodies = make_bodies(rng.uniform(-3, 3, (6, 3)), rng.normal(size=(6, 3)), sizes=np.full(6, 0.5))
    return Scene("sphere", (), bodies, Box(np.full(3, 10.0)))


def test_straight_flight_keeps_every_symmetry():
    errors = invariance(SYMMETRIES, scene(), straight())
    assert list(errors) == list(SYMMETRIES)
    assert max(errors.values()) < 1e-14


@pytest.mark.parametrize(
    ("metric", "bend", "size"),
    [
        # of the body's size: half a metre is one diameter
        ("reversal_error", lambda scene, x: np.add(x, [0, 0.25, 0]), 1.0),
        ("relabelling_error", lambda scene, x: np.add(x, 0.5 * np.eye(6, 3)), 1.0),
        ("mirror_error", lambda scene, x: np.add(x, [0.25, 0, 0]), 1.0),
        ("scaling_error", lambda scene, x: np.add(x, [0, 0, 0.5 if scene.box.half[0] < 1e3 else 0]), 1.0),
    ],
)
def test_a_method_with_a_preference_shows_it_in_the_error_of_that_name(metric, bend, size):
    assert invariance([metric], scene(), straight(bend))[metric] == pytest.approx(size, rel=1e-9)


def test_nothing_is_flown_for_what_nobody_asks():
    def refuse(scene, slower):
        raise AssertionError("flown")

    assert invariance(["energy_drift"], scene(), refuse) == {}


def test_no_body_breaks_no_symmetry():
    empty = replace(scene(), bodies=make_bodies(np.empty((0, 3))))
    assert set(invariance(CHECKS, empty, straight()).values()) == {0.0}


def test_the_mirror_turns_meshes_and_spins_as_well():
    seen = []

    def fly(scene, slower):
        seen.append(scene)
        return straight()(scene, slower)

    original = random_scene("mesh", 3, 6.0, seed=4)
    invariance(["mirror_error"], original, fly)
    _, mirrored = seen
    flip = np.diag([-1.0, 1.0, 1.0])
    for before, after in zip(original.bodies.quaternions, mirrored.bodies.quaternions, strict=True):
        assert rotation(after) == pytest.approx(flip @ rotation(before) @ flip, abs=1e-15)
    corners = mirrored.mesh.vertices[mirrored.mesh.faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume == pytest.approx((1 / 3) ** 1.5)  # of a cube of space diagonal 1: outside has stayed outside


def test_orientations_drift_by_what_the_phase_has_lost_of_its_digits():
    at_rest = scene()
    assert CHECKS["quaternion_drift"](at_rest, straight()(at_rest, 1.0), straight()) == 0.0
    spinning = replace(at_rest, bodies=make_bodies([[0, 0, 0]], spins=[[0.3, -0.4, 1.2]]))
    short, long = (
        CHECKS["quaternion_drift"](spinning, straight()(spinning, slower), straight()) for slower in (1.0, 1e9)
    )
    assert short < 1e-15
    assert 1e-12 < long < 2e9 * 1.3 * 2e-16


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_a_body_that_is_nowhere_is_refused_by_its_number(wrong):
    positions, velocities = np.zeros((4, 3)), np.zeros((4, 3))
    require_finite_state(positions, velocities, 1.0)
    velocities[2, 1] = wrong
    with pytest.raises(NotFiniteError, match="at 1 s the velocity of body 2 is not a finite number"):
        require_finite_state(positions, velocities, 1.0)


def rotation(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
