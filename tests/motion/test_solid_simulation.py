"""Spinning hulls and meshes from event to event, against closed forms, a plain loop, spheres and frames."""

from dataclasses import fields
from decimal import Decimal, localcontext

import numpy as np
import pytest
import trimesh
from scipy.optimize import brentq

from harness.motion.predictive.codes import Event
from harness.motion.predictive.simulation import Simulation
from harness.motion.predictive.solid_simulation import SolidSimulation
from harness.motion.predictive.solids import Form, needs_its_surface
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import convex_hull
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, slow_beyond
from tests.methods import flights
from tests.methods.flights import frames_of, planned
from tests.motion.solid_reference import SolidReference
from tests.narrowphase.meshes import mesh_named, turns

WIDTH = 1 / np.sqrt(3)
PI = Decimal("3.14159265358979323846264338327950288419716939937510")
PUMPKIN = "pumpkin-1753.ply"


def fly(scene, until, response="elastic", restitution=1.0, tolerance=1e-9, max_events=None):
    simulation = SolidSimulation(
        scene.bodies, scene.box, Form(scene), response, restitution, record=True, tolerance=tolerance
    )
    simulation.advance(until, max_events)
    return simulation


def cubes(positions, velocities, half=50.0, **options):
    return Scene("hull", (cube_mesh(),), make_bodies(positions, velocities, **options), Box(np.full(3, float(half))))


def crowd(mesh, count, half, seed, shape="hull", spin=2.0, ratio=1.0):
    """Bodies on a jittered lattice, so that their spheres hardly overlap at the start."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(count ** (1 / 3)))
    steps = (np.arange(side) + 0.5) / side * 2 - 1
    places = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3) * (half - 0.1)
    positions = places[rng.permutation(len(places))[:count]] + rng.uniform(-0.05, 0.05, (count, 3))
    bodies = make_bodies(
        positions,
        rng.normal(size=(count, 3)),
        quaternions=turns(rng, count),
        spins=rng.normal(size=(count, 3)) * spin,
        sizes=ratio ** rng.uniform(-1, 0, count),
    )
    return Scene(shape, (mesh,), bodies, Box(np.full(3, float(half))))


def sequence(events):
    return [(int(e["kind"]), int(e["i"]), int(e["wall"] if e["kind"] == Event.WALL else e["j"])) for e in events]


def until_too_close_to_call(events, tolerance=1e-6):
    """The events up to the first two of which rounding decides which is first."""
    close = np.flatnonzero(np.diff([event[0] for event in events]) <= tolerance)
    return events[: close[0]] if len(close) else events


def test_cubes_meet_face_to_face_and_edge_to_face_on_time():
    slanted = (np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8))
    for turn, reach in (((1, 0, 0, 0), WIDTH), (slanted, WIDTH * (1 + np.sqrt(2)) / 2)):
        scene = cubes([(0, 0, 0), (5, 0, 0)], [(0.5, 0, 0), (-1, 0, 0)], quaternions=[(1, 0, 0, 0), turn])
        events = fly(scene, 10.0, tolerance=1e-12).events
        assert sequence(events) == [(Event.PAIR, 0, 1)]
        assert events["time"][0] == pytest.approx((5 - reach) / 1.5, rel=1e-11)


def test_a_spinning_cube_meets_a_cube_and_a_wall_when_its_edge_has_turned_there():
    rate, speed = 2.0, 0.3

    def gap(t, distance):
        return distance - speed * t - WIDTH / 2 * (abs(np.cos(rate * t)) + abs(np.sin(rate * t)))

    def first(distance):
        times = np.linspace(0, 8, 80_001)
        after = np.argmax(gap(times, distance) <= 0)
        return brentq(gap, times[after - 1], times[after], args=(distance,), xtol=1e-14)

    scene = cubes([(0, 0, 0), (1.5, 0, 0)], [(0, 0, 0), (-speed, 0, 0)], spins=[(0, 0, 0), (0, 0, rate)])
    assert fly(scene, 5.0, tolerance=1e-11).events["time"][0] == pytest.approx(first(1.5 - WIDTH / 2), abs=1e-9)
    alone = cubes([(0, 0, 0)], [(speed, 0, 0)], half=1.9, spins=[(0, 0, rate)])
    assert fly(alone, 7.0, tolerance=1e-11).events["time"][0] == pytest.approx(first(1.9), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "shape", "response", "restitution", "ratio", "seeds"),
    [
        ("cube", "hull", "reflect", 1.0, 1.0, 2),
        ("cube", "hull", "elastic", 0.8, 7.0, 3),
        (PUMPKIN, "hull", "elastic", 1.0, 1.5, 1),
        (PUMPKIN, "mesh", "elastic", 1.0, 1.5, 1),
        ("package:pybullet_data/duck.obj", "mesh", "reflect", 1.0, 1.0, 1),
    ],
)
def test_the_scheduler_meets_the_events_of_the_plain_loop(name, shape, response, restitution, ratio, seeds):
    mesh = cube_mesh() if name == "cube" else mesh_named(name)
    compared = 0
    for seed in range(seeds):
        scene = crowd(mesh, 5, 1.1, seed, shape, ratio=ratio)
        reference = SolidReference(scene, response, restitution)
        while len(reference.events) < 12 and reference.happen():
            pass
        expected = until_too_close_to_call(reference.events)
        found = fly(scene, np.inf, response, restitution, 1e-12, max_events=12).events[: len(expected)]
        assert sequence(found) == [event[1:] for event in expected]
        # chaos multiplies rounding by some ten a hit
        errors = np.abs(found["time"] - [event[0] for event in expected])
        assert errors[0] < 1e-9
        assert errors.max() < 1e-5
        compared += len(expected)
    assert compared >= 5 * seeds


def test_fine_icospheres_fly_as_spheres_do():
    """Inscribed, so that they meet later, by the square of the length of their edges."""
    latest = []
    for level in (2, 3, 4):
        sphere = trimesh.creation.icosphere(subdivisions=level, radius=0.5)
        hull = convex_hull(np.array(sphere.vertices))
        mesh = Mesh("icosphere", hull.vertices, hull.faces, hull, "", watertight=True, convex=True)
        scene = crowd(mesh, 20, 2.2, 5)
        bodies = scene.bodies
        exact = Simulation(
            bodies.positions,
            bodies.velocities,
            bodies.radii,
            bodies.masses,
            scene.box.half,
            "elastic",
            record=True,
        )
        exact.advance(np.inf, max_events=8)
        found = fly(scene, np.inf, tolerance=1e-10, max_events=8).events
        assert sequence(found) == sequence(exact.events)
        late = found["time"] - exact.events["time"]
        assert late[0] >= -1e-9
        latest.append(np.abs(late).max() / sphere.edges_unique_length.mean() ** 2)
    assert max(latest) < 0.5
    assert max(latest) / min(latest) < 4


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_the_lateness_of_frames_is_of_first_order_in_their_length(shape):
    scene = crowd(mesh_named(PUMPKIN), 6, 1.2, 2, shape)
    first = 10
    exact = fly(scene, np.inf, tolerance=1e-10, max_events=first).events
    lateness = []
    for dt in (2e-3, 5e-4, 1.25e-4):
        frames = round((exact["time"][-1] + 0.02) / dt)
        trace = flights.fly(scene, "grid", frames_of(frames, dt, "elastic")).trace
        order = [(*bodies, wall) for bodies, wall in zip(trace.bodies.tolist(), trace.walls.tolist(), strict=True)]
        assert order[:first] == [(e["i"], e["j"], e["wall"]) for e in exact]
        lateness.append(np.mean(np.abs(trace.times[:first] - exact["time"])))
    orders = np.log(np.divide(lateness[:-1], lateness[1:])) / np.log(4)
    assert ((orders > 0.5) & (orders < 1.5)).all()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "shape"), [("cube", "hull"), (PUMPKIN, "mesh")])
def test_without_a_response_every_onset_is_found_and_no_other(name, shape):
    mesh, dt, until = cube_mesh() if name == "cube" else mesh_named(name), 1e-3, 2.5
    scene = crowd(mesh, 8, 1.4, 3, shape)
    simulation = fly(scene, until, "none", tolerance=1e-8)
    exact = simulation.events
    trace = flights.fly(scene, "grid", frames_of(round(until / dt), dt, "none")).trace
    pairs = exact[exact["kind"] == Event.PAIR]
    seen = sorted((*trace.bodies[k], trace.times[k]) for k in np.flatnonzero(trace.walls < 0))
    onsets = sorted(zip(pairs["i"], pairs["j"], pairs["time"], strict=True))
    assert [event[:2] for event in seen] == [event[:2] for event in onsets]
    late = np.array([event[2] for event in seen]) - [event[2] for event in onsets]
    assert -1e-9 < late.min() <= late.max() < dt * (1 + 1e-9)
    assert len(onsets) > 20
    assert np.allclose(simulation.positions, trace.positions, atol=1e-12)


@pytest.mark.parametrize("shape", ["hull", "mesh"])
@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
def test_a_run_is_the_same_to_the_bit_however_it_is_sampled(shape, response):
    scene = crowd(mesh_named(PUMPKIN), 20, 2.0, 7, shape, ratio=4.0)
    whole = fly(scene, 1.5, response, tolerance=1e-6)
    pieces = SolidSimulation(scene.bodies, scene.box, Form(scene), response, record=True)
    for time in np.linspace(0, 1.5, 100):
        pieces.advance(time)
        pieces.positions_at(time)
    assert np.array_equal(whole.events, pieces.events)
    assert np.array_equal(whole.positions, pieces.positions)
    assert whole.counters == pieces.counters


def test_contacts_followed_with_fields_begin_when_they_do_without_and_are_followed_in_fewer_steps():
    scene = crowd(mesh_named(PUMPKIN), 20, 2.0, 7, "mesh", spin=10.0)
    plain, helped = (
        SolidSimulation(scene.bodies, scene.box, Form(scene, followed=followed), "none", record=True)
        for followed in (False, True)
    )
    for simulation in (plain, helped):
        simulation.advance(1.5)
    assert sequence(plain.events) == sequence(helped.events)
    assert helped.events["time"] == pytest.approx(plain.events["time"], abs=1e-9)
    before, after = plain.counters, helped.counters
    assert before.pop("advancement_steps") - after.pop("advancement_steps") > 200 * before["pair_hits"] > 8000
    assert before == after


def test_bodies_in_another_order_meet_as_before():
    scene = crowd(mesh_named(PUMPKIN), 12, 1.7, 11, "mesh", ratio=5.0)
    bodies, order = scene.bodies, np.random.default_rng(0).permutation(12)
    shuffled = Bodies(*(getattr(bodies, field.name)[order] for field in fields(bodies)))
    one = fly(scene, np.inf, tolerance=1e-10, max_events=15).events
    other = fly(Scene("mesh", (scene.mesh,), shuffled, scene.box), np.inf, tolerance=1e-10, max_events=15).events
    assert np.allclose(one["time"], other["time"], atol=1e-6)
    for a, b in zip(one, other, strict=True):
        assert a["wall"] == b["wall"]
        assert {a["i"], a["j"]} == {order[b["i"]], order[b["j"]] if b["j"] >= 0 else -1}


@pytest.mark.parametrize("shape", ["hull", "mesh"])
@pytest.mark.parametrize("response", slow_beyond(["reflect", "elastic", "none"]))
def test_ten_bodies_that_cannot_fit_into_their_box_come_to_an_end(shape, response):
    rng = np.random.default_rng(259)
    bodies = make_bodies(
        rng.uniform(-0.5, 0.5, (10, 3)),
        rng.normal(size=(10, 3)),
        spins=rng.normal(size=(10, 3)),
        quaternions=turns(rng, 10),
        sizes=[1] * 8 + [0.3, 0.1],
    )
    bodies.positions[1] = bodies.positions[0]
    scene = Scene(shape, (mesh_named(PUMPKIN),), bodies, Box(np.full(3, 1.0)))
    simulation = fly(scene, 0.3, response, tolerance=1e-6)
    assert simulation.time == 0.3
    assert np.isfinite(simulation.positions).all()
    assert (np.diff(simulation.events["time"]) >= 0).all()
    if response != "none":
        assert simulation.kinetic_energy == pytest.approx(0.5 * (bodies.masses @ (bodies.velocities**2).sum(axis=1)))


@pytest.mark.slow
def test_energy_is_kept_over_thousands_of_hits_and_no_body_escapes():
    scene = crowd(cube_mesh(), 60, 2.6, 1)
    simulation = fly(scene, np.inf, tolerance=1e-6, max_events=20_000)
    before = 0.5 * scene.bodies.masses @ (scene.bodies.velocities**2).sum(axis=1)
    assert simulation.counters["pair_hits"] > 5000
    assert simulation.counters["stalled_events"] == 0
    assert abs(simulation.kinetic_energy / before - 1.0) < 1e-12
    assert (np.abs(simulation.positions) <= 2.6).all()
    assert abs(simulation.virial_residual) < 1e-10


def test_a_rib_that_strikes_while_the_centres_separate_goes_through_in_silence():
    bar = convex_hull(cube_mesh().hull.vertices * [1, 0.1, 0.1] / np.linalg.norm([1, 0.1, 0.1]) * np.sqrt(3))
    mesh = Mesh("bar", bar.vertices, bar.faces, bar, "", watertight=True, convex=True)
    bodies = make_bodies([(0, 0, 0), (0.3, 0, 0)], [(0, 0, 0), (0.01, 0, 0)], spins=[(0, 0, 0), (0, 0, 3)])
    bodies.quaternions[:] = (np.sqrt(0.5), 0, 0, np.sqrt(0.5))
    scene = Scene("hull", (mesh,), bodies, Box(np.full(3, 5.0)))
    assert len(fly(scene, 3.0).events) == 0
    assert len(fly(scene, 3.0, "none").events) >= 1
    # with the centres approaching, the same stroke counts
    bodies.velocities[1, 0] = -0.01
    assert len(fly(scene, 3.0).events) >= 1


@pytest.mark.slow
def test_orientations_keep_their_digits_in_long_runs():
    scene = crowd(cube_mesh(), 3, 1.2, 4, spin=40.0)
    bodies = scene.bodies
    bodies.velocities *= 1e-4
    simulation = fly(scene, np.inf, max_events=200)
    body, clock = simulation._solid.body, simulation._world.totals.clock[0]
    assert clock["epoch"] > 1e4
    for turn, spin, start in zip(body.turns, bodies.spins, bodies.quaternions, strict=True):
        with localcontext() as context:
            context.prec = 60
            rate = sum(Decimal(x) ** 2 for x in spin.tolist()).sqrt()
            half = float(rate * (Decimal(float(clock["epoch"])) + Decimal(float(clock["epoch_rest"]))) / 2 % (2 * PI))
        w, v = np.cos(half), np.sin(half) * spin / float(rate)
        exact = [w * start[0] - v @ start[1:], *(w * start[1:] + start[0] * v + np.cross(v, start[1:]))]
        assert np.abs(turn - exact).max() < 1e-14


def test_the_plan_says_what_is_searched():
    pumpkin = crowd(mesh_named(PUMPKIN), 3, 2.0, 0, "mesh")
    cubes_ = crowd(cube_mesh(), 3, 2.0, 0, "mesh")
    for scene, mesh_search in ((pumpkin, True), (cubes_, False)):
        plan = planned(scene, "predictive", frames_of(10, 0.1, "elastic"))
        assert plan.keeps("mesh_search") == mesh_search == Form(scene).concave
        assert plan.keeps("hull_search")
        assert plan.keeps("wall_search")
    still = planned(pumpkin, "predictive", frames_of(10, 0.1, "none"))
    assert not still.keeps("wall_search")


def test_where_there_are_no_bodies_no_surface_is_searched():
    none = np.empty((0, 3))
    assert not needs_its_surface(Scene("mesh", (cube_mesh(),), make_bodies(none, none), Box(np.ones(3))))
