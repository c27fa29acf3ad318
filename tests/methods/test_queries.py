"""Tolerance, distance and impact: whatever the algorithm, the answers are those of every pair, and they are true."""

from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.errors import InputError
from harness.methods.registry import method_of
from harness.motion.kinematics import Trajectory
from harness.motion.law import MotionLaw
from harness.reference.hit_errors import hit_errors
from harness.reference.scene_contacts import scene_contacts
from harness.scene.scene import Scene
from harness.vocabulary import MethodName
from tests.conftest import cube_mesh, make_bodies, random_scene, slow_beyond

CULLED = ("grid", "sap", "tree")
SHAPES = ("sphere", "hull", "mesh")
WITHIN = 0.2
LAW = MotionLaw(2.0, 0.25, "none")


def asked(scene, query, algorithm="grid", law=LAW, tolerance=1e-9, within=WITHIN):
    """The outcome of a flight that asks a query."""
    name = MethodName("fcl", algorithm, scene.shape, query)
    method = method_of(name, tolerance=tolerance, within=within if query in ("tolerance", "distance") else None)
    return method.load(scene, method.plan(scene, law)).fly(law, traced=True)


def mixed(shape, seed=3):
    """A dozen bodies of different sizes that spin, meet, and are turned by walls within frames."""
    scene, rng = random_scene(shape, 12, 3.0, seed), np.random.default_rng(seed)
    bodies = make_bodies(
        scene.bodies.positions,
        velocities=rng.normal(size=(12, 3)),
        spins=3.0 * rng.normal(size=(12, 3)),
        sizes=rng.uniform(0.4, 1.2, 12),
        quaternions=scene.bodies.quaternions,
    )
    return Scene(shape, (cube_mesh(),), bodies, scene.box)


def by_pair(answers):
    """What was answered of each pair of each frame."""
    rows = zip(answers.frames.tolist(), *answers.pairs.T.tolist(), strict=True)
    return dict(zip(rows, zip(answers.gaps, answers.points, strict=True), strict=True))


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("query", ["tolerance", "distance"])
def test_no_cull_loses_a_near_pair(query, shape):
    scene = mixed(shape)
    every = asked(scene, query, "brute-force")
    expected = by_pair(every.answers)
    assert len(expected) > 50
    for algorithm in CULLED:
        found = asked(scene, query, algorithm)
        answered = by_pair(found.answers)
        assert answered.keys() == expected.keys()
        if query == "distance":
            assert [gap for gap, _ in answered.values()] == pytest.approx(
                [gap for gap, _ in expected.values()], abs=2e-9
            )
        assert found.metrics["event_digest"] == every.metrics["event_digest"]
        assert found.metrics["narrow_tests"] < every.metrics["narrow_tests"] == 12 * 11 / 2 * LAW.frames


@pytest.mark.parametrize("shape", SHAPES)
def test_the_gaps_of_a_run_are_those_of_every_pair_by_itself(shape):
    scene = mixed(shape)
    found = by_pair(asked(scene, "distance").answers)
    trajectory = Trajectory(scene.bodies, scene.box, folded=True, turning=True)
    near = 0
    for frame in range(1, LAW.frames + 1):
        trajectory.move_to(frame * LAW.dt)
        bodies = [
            harness.Body(cube_mesh(), x, q, size, shape=shape)
            for x, q, size in zip(trajectory.positions, trajectory.quaternions, scene.bodies.sizes, strict=True)
        ]
        for i in range(12):
            for j in range(i + 1, 12):
                gap = harness.distance(bodies[i], bodies[j]).gap
                assert ((frame, i, j) in found) == (gap <= WITHIN)
                if gap <= WITHIN:
                    near += 1
                    assert found[frame, i, j][0] == pytest.approx(gap, abs=1e-9)
                    ends = found[frame, i, j][1]
                    assert np.linalg.norm(ends[0] - ends[1]) == pytest.approx(gap, abs=1e-9)
    assert near == len(found)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("dt", slow_beyond([1.0, 0.1]))
def test_every_hit_of_the_reference_is_found_at_its_time_however_long_a_frame_is(shape, dt):
    scene, law = mixed(shape), MotionLaw(2.0, dt, "none")
    contacts = scene_contacts(scene, law.duration, 1e-9)
    for algorithm in ("brute-force", *CULLED):
        trace = asked(scene, "impact", algorithm, law).trace
        errors = hit_errors(contacts, 0.0, trace, None)
        assert errors["reference_hits"] > 10
        assert (errors["missed_hits"], errors["extra_hits"]) == (0.0, 0.0)
        assert errors["time_error_95"] < 1e-8


@pytest.mark.parametrize("shape", SHAPES)
def test_what_impact_sees_and_frames_do_not_is_over_or_has_parted_between_two_of_them(shape):
    scene, dt = mixed(shape), LAW.dt
    contacts = scene_contacts(scene, LAW.duration, 1e-9)
    of_pairs = map(tuple, contacts.pairs[contacts.encounter].tolist())
    spans = list(zip(of_pairs, contacts.onset, contacts.release, strict=True))
    onsets = {query: hits_of(asked(scene, query).trace) for query in ("impact", "collision")}
    by_frame = {(pair, round(time / dt)) for pair, time in onsets["collision"]}
    unseen = 0
    for pair, time in onsets["impact"]:
        frame = int(np.ceil(time / dt))
        if (pair, frame) not in by_frame:
            unseen += 1
            short = any(p == pair and abs(begin - time) < 1e-7 and end < frame * dt for p, begin, end in spans)
            again = any(p == pair and begin <= (frame - 1) * dt <= end < time for p, begin, end in spans)
            assert short or again
    assert unseen > 0


def hits_of(trace):
    """Which pairs of a trace hit, and when."""
    pairs = trace.walls < 0
    return list(zip(map(tuple, trace.bodies[pairs].tolist()), trace.times[pairs].tolist(), strict=True))


def test_a_pair_that_touches_is_not_reported_until_it_has_parted():
    # flies through the other from 0.5 to 2.5 s, and comes back from the wall at 6.5 to 8.5 s
    bodies = make_bodies([[-1.5, 0.0, 0.0], [0.0, 0.0, 0.0]], velocities=[[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    scene = Scene("sphere", (), bodies, replace(random_scene("sphere", 2, 6.0).box, half=np.full(3, 3.5)))
    for dt in (0.1, 0.7, 9.1):
        trace = asked(scene, "impact", law=MotionLaw(9.1, dt, "none")).trace
        assert trace.times[trace.walls < 0] == pytest.approx([0.5, 6.5], abs=1e-14)


def test_bodies_that_touch_at_the_start_have_not_begun_to():
    bodies = make_bodies([[-0.3, 0.0, 0.0], [0.3, 0.0, 0.0]], velocities=[[0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]])
    turned = make_bodies(bodies.positions, bodies.velocities, quaternions=[[1.0, 0.0, 0.0, 0.0], [0.9, 0.1, 0.2, 0.3]])
    for shape in SHAPES:
        scene = Scene(shape, (cube_mesh(),), turned, random_scene("sphere", 2, 8.0).box)
        found = asked(scene, "impact", law=MotionLaw(0.5, 0.1, "none"))
        assert found.metrics["pair_hits"] == 0


@pytest.mark.parametrize("shape", ["hull", "mesh"])
@pytest.mark.parametrize("where", ["beside", "over", "along a diagonal"])
def test_cubes_whose_faces_slide_over_each_other_meet_once_each_way_at_the_exact_time(shape, where):
    # coplanar faces neither cross nor come apart: what follows a contact has nothing but the gap, which stays 0
    edge = 1.0 / np.sqrt(3.0)
    room = 2.5 - 0.5  # of the centre of a cube, from the middle of the box
    across = {"beside": (edge, 0.0), "over": (0.25 * edge, edge), "along a diagonal": (edge, edge)}[where]
    scene = two_cubes(shape, (-1.5, *across), (1.0, 0.0, 0.0), side=5.0)
    found = asked(scene, "impact", law=MotionLaw(7.0, 0.5, "none"))
    times = [time for _, time in hits_of(found.trace)]
    expected = np.array([1.5 - edge, (1.5 + room) + (room - edge)])
    assert len(times) == 2
    assert np.all(times <= expected + 1e-14)  # never late
    assert np.all(times >= expected - 1e-9)  # early by no more than the tolerance of 1e-9 at 1 m/s


@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_cubes_that_rest_or_slide_on_each_other_from_the_start_have_not_begun_to(shape):
    edge = 1.0 / np.sqrt(3.0)
    for velocity in ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.1, 0.0, -0.2)):
        scene = two_cubes(shape, (0.2 * edge, edge, 0.1 * edge), velocity, side=20.0)
        assert not hits_of(asked(scene, "impact", law=MotionLaw(1.0, 0.25, "none")).trace)


@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_cubes_that_slide_past_each_other_a_millionth_apart_do_not_meet(shape):
    edge = 1.0 / np.sqrt(3.0)
    scene = two_cubes(shape, (-1.5, edge + 1e-6, 0.1), (1.0, 0.0, 0.0), side=20.0)
    assert not hits_of(asked(scene, "impact", law=MotionLaw(3.0, 0.5, "none")).trace)


def two_cubes(shape, position, velocity, side):
    """Cubes of space diagonal 1 in a box, of which the second rests in its middle."""
    bodies = make_bodies([position, [0.0, 0.0, 0.0]], velocities=[velocity, [0.0, 0.0, 0.0]])
    return Scene(shape, (cube_mesh(),), bodies, random_scene("sphere", 2, side).box)


@pytest.mark.parametrize("query", ["tolerance", "distance", "impact"])
def test_bodies_at_rest_are_asked_about_once(query):
    still = make_bodies([[-0.55, 0.0, 0.0], [0.55, 0.0, 0.0]])
    scene = Scene("sphere", (), still, random_scene("sphere", 2, 8.0).box)
    found = asked(scene, query)
    assert found.metrics["narrow_tests"] == LAW.frames * (query != "impact")
    assert found.metrics.get("near_pairs", 0) == LAW.frames * (query != "impact")
    assert not len(found.trace.times) or found.trace.near


def test_a_plan_says_of_every_stage_of_another_query_why_it_is_left_out():
    scene = mixed("mesh")
    for query, kept in (("distance", "surface_gap"), ("impact", "mesh_search")):
        method = method_of(MethodName("fcl", "grid", "mesh", query), within=None if query == "impact" else WITHIN)
        plan = method.plan(scene, LAW)
        assert {"sphere_cull", kept} <= plan.kept
        assert not {"hull_axis", "crossing", "fcl", "containment", "response", "penetration"} & plan.kept
        assert all(stage.why for stage in plan.stages)


def test_a_stage_whose_lack_would_change_an_answer_cannot_be_forced_off():
    name = MethodName("fcl", "grid", "mesh", "distance")
    method = method_of(name, within=WITHIN, forced={"surface_gap": False})
    with pytest.raises(InputError, match="surface_gap cannot be forced off: there would be no gap"):
        method.plan(mixed("mesh"), LAW)
