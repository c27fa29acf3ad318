"""Ignored pairs in event-driven flight: two groups that ignore each other fly as if each were alone."""

from dataclasses import fields

import numpy as np
import pytest

from harness.methods.registry import method_of
from harness.motion.law import MotionLaw
from harness.motion.predictive.simulation import Simulation
from harness.motion.predictive.solid_simulation import SolidSimulation
from harness.motion.predictive.solids import Form
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.launch import directions, orientations
from harness.scene.scene import Scene
from harness.vocabulary import MethodName
from tests.conftest import cube_mesh, make_bodies, slow_beyond

COUNT = 120
FIRST = np.arange(0, COUNT, 3)  # of two groups, mixed in their numbers
SECOND = np.setdiff1d(np.arange(COUNT), FIRST)


def between(one, other):
    """All pairs of one of each group, i < j."""
    pairs = np.stack(np.meshgrid(one, other, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)


def crowd(count=COUNT, spacing=1.04, sizes=(1.0, 1.0)):
    """Spinning bodies on a lattice, apart from each other, and their box."""
    rng = np.random.default_rng(11)
    steps = (np.arange(5) - 2.0) * spacing
    places = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    bodies = Bodies(
        places[rng.permutation(len(places))[:count]],
        rng.normal(size=(count, 3)),
        orientations(rng, count),
        directions(rng, count),
        (sizes_of := rng.uniform(*sizes, count)),
        sizes_of**3,
    )
    return bodies, Box(np.full(3, 2.5 * spacing))


def of_group(bodies, group):
    return Bodies(*(getattr(bodies, field.name)[group] for field in fields(Bodies)))


def hits(events, labels=None):
    """Of a group alone, the bodies by their number in the whole."""
    labels = np.arange(COUNT) if labels is None else labels
    return [
        (float(e["time"]), int(labels[e["i"]]), int(labels[e["j"]]) if e["j"] >= 0 else -1, int(e["wall"]))
        for e in events
    ]


def require_same(found, expected):
    found, expected = sorted(found), sorted(expected)
    assert [hit[1:] for hit in found] == [hit[1:] for hit in expected]
    assert np.allclose([hit[0] for hit in found], [hit[0] for hit in expected], rtol=0, atol=1e-7)


@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize(("search", "least"), [("cells", 1.0), ("cells", 0.15), ("lists", 1.0)])
def test_two_groups_of_spheres_that_ignore_each_other_fly_as_if_alone(search, least, response):
    bodies, box = crowd(sizes=(least, 1.0))

    def fly(group, **options):
        some = of_group(bodies, group)
        state = some.positions, some.velocities, some.radii, some.masses, box.half
        simulation = Simulation(*state, response, record=True, search=search, **options)
        simulation.advance(0.8)
        return simulation

    both = fly(np.arange(COUNT), ignored=between(FIRST, SECOND))
    one, other = fly(FIRST), fly(SECOND)
    assert one.counters["pair_hits"] > 5
    assert both.counters["pair_hits"] == one.counters["pair_hits"] + other.counters["pair_hits"]
    assert both.kinetic_energy == pytest.approx(one.kinetic_energy + other.kinetic_energy, rel=1e-12)
    require_same(hits(both.events), hits(one.events, FIRST) + hits(other.events, SECOND))


@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize("least", [1.0, 0.3])
def test_two_groups_of_hulls_that_ignore_each_other_fly_as_if_alone(least, response):
    bodies, box = crowd(sizes=(least, 1.0), spacing=1.0)

    def fly(group, **options):
        some = of_group(bodies, group)
        form = Form(Scene("hull", (cube_mesh(),), some, box))
        simulation = SolidSimulation(some, box, form, response, record=True, tolerance=1e-10, **options)
        simulation.advance(0.8)
        return simulation

    both = fly(np.arange(COUNT), ignored=between(FIRST, SECOND))
    one, other = fly(FIRST), fly(SECOND)
    assert one.counters["pair_hits"] > 5
    assert both.counters["pair_hits"] == one.counters["pair_hits"] + other.counters["pair_hits"]
    require_same(hits(both.events), hits(one.events, FIRST) + hits(other.events, SECOND))


@pytest.mark.parametrize("shape", slow_beyond(["hull", "sphere", "mesh"]))
def test_predictive_sees_the_hits_of_frames_and_no_ignored_pair(shape):
    (bodies, box), law = crowd(40, sizes=(0.6, 1.0)), MotionLaw(1.0, 4e-3, "none")
    meshes = () if shape == "sphere" else (cube_mesh(),)

    def flown(algorithm, **more):
        scene = Scene(shape, meshes, bodies, box, **more)
        method = method_of(MethodName.read(algorithm, shape))
        trace = method.load(scene, method.plan(scene, law)).fly(law, traced=True).trace
        pairs = trace.walls < 0
        return list(zip(trace.times[pairs].tolist(), map(tuple, trace.bodies[pairs].tolist()), strict=True))

    everything = flown("fcl/predictive")
    ignored = sorted({pair for _, pair in everything})[::2]
    found = flown("fcl/predictive", ignored=np.array(ignored))
    assert [pair for _, pair in found] == [pair for _, pair in everything if pair not in ignored]
    for algorithm in ("fcl/grid", "fcl"):
        seen = [hit for hit in flown(algorithm, ignored=np.array(ignored)) if hit[0] > 8e-3]
        assert len(seen) > 3
        for time, pair in seen:
            assert any(pair == other and time - 4.1e-3 <= at <= time for at, other in found), (algorithm, time)


@pytest.mark.parametrize("response", ["reflect", "elastic"])
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_an_ignored_pair_flies_through_each_other_and_penetrates_nothing(shape, response):
    bodies = make_bodies([[-2, 0, 0], [2, 0, 0], [0, 3, 0]], [[1, 0, 0], [-1, 0, 0], [0, 0, 0]])
    meshes = () if shape == "sphere" else (cube_mesh(),)
    scene = Scene(shape, meshes, bodies, Box(np.full(3, 5.0)), ignored=np.array([[0, 1]]))
    law = MotionLaw(4.0, 0.5, response)
    method = method_of(MethodName.read("fcl/predictive", shape))
    flown = method.load(scene, method.plan(scene, law)).fly(law, traced=True)
    assert flown.metrics["pair_hits"] == flown.metrics["energy_drift"] == 0
    assert flown.metrics.get("max_penetration", 0.0) == 0.0
    assert flown.trace.positions[:2, 0].tolist() == [2.0, -2.0]
