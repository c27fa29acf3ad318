"""What a plan leaves out is not needed: with it or without, a run answers the same hits, to the bit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.methods.culled import DETECTION
from harness.methods.registry import method_of
from harness.methods.stages import StageError
from harness.methods.stepping import Stepping
from harness.motion.law import MotionLaw
from harness.motion.reach import SLACK, fastest, no_pair_can_meet
from harness.scene.box import Box
from harness.scene.mesh_file import make_mesh
from harness.scene.scene import Scene
from harness.vocabulary import MethodName
from tests.conftest import cube_mesh, examples, make_bodies, random_scene
from tests.methods.flights import detector, frames_of, method_for, planned
from tests.narrowphase.meshes import mesh_named

RESPONSES = ("reflect", "elastic", "none")


def fly(scene, algorithm="grid", response="reflect", forced=None, frames=40, dt=1 / 30):
    law = frames_of(frames, dt, response)
    method = method_for(scene, algorithm, forced=forced)
    plan = method.plan(scene, law)
    return plan, method.load(scene, plan).fly(law, traced=True)


def story(outcome):
    trace, metrics = outcome.trace, outcome.metrics
    counted = [metrics[name] for name in ("event_digest", "pair_hits", "box_hits", "pair_contacts", "escaped")]
    arrays = (trace.times, trace.bodies, trace.walls, trace.positions, trace.velocities)
    return [*counted, *(array.tolist() for array in arrays)]


def stages(scene, algorithm="grid", response="reflect", duration=10.0, forced=None):
    law = MotionLaw(duration, duration or 1.0, response)
    return {stage.name: stage for stage in planned(scene, algorithm, law, forced=forced).stages}


def two(gap, speed=0.0, side=100.0, **more):
    """Two spheres this far apart that fly toward each other along x."""
    velocities = [[speed, 0, 0], [-speed, 0, 0]]
    return Scene("sphere", (), make_bodies([[0, 0, 0], [1 + gap, 0, 0]], velocities, **more), Box(np.full(3, side)))


@st.composite
def scenes(draw):
    """Crowds and loners, at rest or not, of one size or several, convex or not."""
    shape = draw(st.sampled_from(["sphere", "hull", "mesh"]))
    scene = random_scene(
        shape, draw(st.sampled_from([1, 2, 8])), draw(st.sampled_from([2.0, 4.0, 40.0])), draw(st.integers(0, 10**6))
    )
    bodies = scene.bodies.copy()
    bodies.velocities *= draw(st.sampled_from([0.0, 1e-3, 1.0]))
    bodies.spins *= draw(st.sampled_from([0.0, 1.0]))
    if draw(st.booleans()):
        bodies.sizes *= np.linspace(1.0, 0.2, len(bodies))
    mesh = mesh_named("pumpkin-1753.ply") if draw(st.booleans()) else cube_mesh()
    return Scene(shape, (mesh,), bodies, scene.box)


@settings(max_examples=examples(15))
@given(scenes(), st.sampled_from(["grid", "tree"]), st.sampled_from(RESPONSES))
def test_every_stage_that_may_be_forced_the_other_way_leaves_every_hit_as_it_is(scene, algorithm, response):
    plan, outcome = fly(scene, algorithm, response)
    for stage in plan.stages:
        try:
            _, forced = fly(scene, algorithm, response, {stage.name: not stage.kept})
        except StageError:
            continue
        assert story(forced) == story(outcome), stage


@settings(max_examples=examples(10))
@given(scenes(), st.sampled_from(RESPONSES))
def test_what_is_left_out_changes_no_hit_of_brute_force_which_leaves_nothing_out(scene, response):
    (_, brute), (_, grid) = fly(scene, "brute-force", response), fly(scene, "grid", response)
    assert story(grid) == story(brute)
    count = len(scene.bodies)
    assert brute.metrics["pair_tests"] == brute.metrics["narrow_tests"] == 40 * count * (count - 1) // 2
    assert brute.metrics["box_tests"] == (0 if response == "none" else 40 * 6 * count)


@settings(max_examples=examples(8))
@given(scenes(), st.sampled_from(["grid", "tree"]), st.sampled_from(RESPONSES))
def test_bodies_at_rest_are_looked_at_once_and_counted_as_if_in_every_frame(scene, algorithm, response):
    scene.bodies.velocities[:] = scene.bodies.spins[:] = 0.0
    plan, outcome = fly(scene, algorithm, response, {"pairs": True} if len(scene.bodies) > 1 else {})
    if not plan.keeps("pairs"):
        return
    asked = []

    class Asked:
        def __init__(self):
            self.detector = detector(scene, algorithm)

        @property
        def counters(self):
            return self.detector.counters

        def pairs(self, positions, quaternions):
            asked.append(positions)
            return self.detector.pairs(positions, quaternions)

    again = Stepping(scene, plan, Asked()).fly(frames_of(40, 1 / 30, response), traced=True)
    assert len(asked) <= 3
    _, full = fly(scene, algorithm, response, {"motion": True, "pairs": True})
    exact = [name for name in full.metrics if "second" not in name]
    for found in (outcome, again):
        assert {name: found.metrics[name] for name in exact} == {name: full.metrics[name] for name in exact}
        assert story(found) == story(full)


def test_each_case_is_recognised():
    cubes, alone = random_scene("hull", 8, 4.0), random_scene("hull", 1, 4.0)
    assert not stages(alone)["pairs"].kept
    assert not stages(random_scene("sphere", 8, 4.0))["orientations"].kept
    assert not stages(random_scene("sphere", 8, 4.0))["fcl"].kept
    assert stages(cubes)["orientations"].kept
    assert not stages(cubes)["size_classes"].kept
    assert stages(Scene("hull", (cubes.mesh,), replaced(cubes, sizes=np.linspace(1, 2, 8)), cubes.box))[
        "size_classes"
    ].kept
    still = Scene("hull", (cubes.mesh,), replaced(cubes, spins=np.zeros((8, 3))), cubes.box)
    assert not stages(still)["orientations"].kept
    assert stages(still)["motion"].kept
    rest = Scene("hull", (cubes.mesh,), replaced(still, velocities=np.zeros((8, 3))), cubes.box)
    assert not stages(rest)["motion"].kept
    assert stages(rest, "brute-force")["motion"].kept
    assert not stages(cubes)["recording"].kept
    nobody = Scene("sphere", (), make_bodies(np.empty((0, 3))), Box(np.ones(3)))
    assert not stages(nobody)["pairs"].kept
    assert not stages(nobody)["walls"].kept


def replaced(scene, **arrays):
    return replace(scene.bodies, **arrays)


def test_a_convex_mesh_of_one_size_is_judged_by_its_hull_alone():
    cube = cube_mesh()
    mesh = make_mesh("cube", cube.vertices, cube.faces)
    assert mesh.convex
    crowd = random_scene("mesh", 20, 2.5)
    scene = Scene("mesh", (mesh,), crowd.bodies, crowd.box)
    found = stages(scene)
    assert not found["crossing"].kept
    assert not found["containment"].kept
    _, outcome = fly(scene)
    assert outcome.metrics["fcl_tests"] < 0.01 * outcome.metrics["narrow_tests"]
    assert story(outcome) == story(fly(scene, forced={"crossing": True})[1])
    assert story(outcome) == story(fly(scene, "brute-force")[1])
    mixed = Scene("mesh", (mesh,), replaced(crowd, sizes=np.linspace(0.1, 1.5, 20)), crowd.box)
    assert stages(mixed)["crossing"].kept
    assert stages(mixed)["containment"].kept
    pumpkins = Scene("mesh", (mesh_named("pumpkin-1753.ply"),), crowd.bodies, crowd.box)
    assert stages(pumpkins)["crossing"].kept


def test_pairs_are_left_out_just_where_no_pair_can_meet():
    """Head on, 1 m of gap at 1 m/s each: they meet after half a second, and not before."""
    assert no_pair_can_meet(two(1.0, 1.0), 0.5 * (1 - 1e-6))
    assert not no_pair_can_meet(two(1.0, 1.0), 0.5)
    assert not no_pair_can_meet(two(0.0), 0.0)  # they touch
    assert not stages(two(1.0, 1.0), duration=0.49)["pairs"].kept
    assert stages(two(1.0, 1.0), "brute-force", duration=0.49)["pairs"].kept


@pytest.mark.parametrize("response", ["reflect", "elastic"])
def test_walls_are_left_out_just_where_no_body_can_get_to_one(response):
    """Along x, 10 m from the centre to the wall, of which the sphere fills half a metre: 9.5 s at 1 m/s."""
    bodies = make_bodies([[0, 0, 0]], [[1, 0, 0]])
    scene = Scene("sphere", (), bodies, Box(np.array([10.0, 1.0, 1.0])))
    assert not stages(scene, response=response, duration=9.5 * (1 - 1e-6))["walls"].kept
    assert stages(scene, response=response, duration=9.5)["walls"].kept
    assert stages(scene, "brute-force", response=response, duration=0.1)["walls"].kept


def test_in_elastic_hits_a_light_body_is_bounded_by_all_of_the_energy():
    """A heavy sphere kicks a light one that rests up to nearly twice its own speed."""
    scene = two(1.0, 0.0, masses=[100.0, 1e-3])
    scene.bodies.velocities[0, 0] = 1.0
    bound = fastest(scene, "elastic")
    assert bound == pytest.approx([1.0, np.sqrt(100.0 / 1e-3)])
    _, outcome = fly(scene, response="elastic", frames=60)
    speeds = np.linalg.norm(outcome.trace.velocities, axis=1)
    assert outcome.metrics["pair_hits"] == 1
    assert speeds[1] == pytest.approx(2.0, rel=1e-4)
    assert (speeds <= bound * (1 + SLACK)).all()
    assert fastest(scene, "reflect") == pytest.approx([1.0, 0.0])


@pytest.mark.parametrize(
    ("forced", "said"),
    [
        ({"pairs": False}, "pairs cannot be forced off: hits would be missed"),
        ({"walls": False}, "walls cannot be forced off"),
        ({"fcl": False}, "fcl cannot be forced off"),
        ({"orientations": False}, "orientations cannot be forced off"),
        ({"hull_axes": False}, 'no stage "hull_axes"; did you mean "hull_axis"?'),
        ({"hull_axis": False, "crossing": True}, "keep hull_axis"),
    ],
)
def test_a_stage_that_is_needed_or_unknown_is_refused_in_a_sentence(forced, said):
    with pytest.raises(StageError, match=said.replace("?", r"\?")):
        stages(random_scene("mesh", 8, 4.0), forced=forced)


def test_all_that_is_refused_is_said_at_once():
    with pytest.raises(StageError) as refused:
        stages(random_scene("mesh", 8, 4.0), forced={"hul_axis": False, "pairs": False, "walls": False})
    assert [name for name, _ in refused.value.refusals] == ["pairs", "walls", "hul_axis"]


def test_brute_force_can_be_made_to_leave_out_nothing():
    for name in DETECTION:
        if name != "fcl":
            with pytest.raises(StageError, match="brute force leaves nothing out"):
                stages(random_scene("mesh", 8, 4.0), "brute-force", forced={name: True})


def test_a_plan_says_how_many_pairs_are_ignored_and_which_meshes_there_are():
    cube, pumpkin = cube_mesh(), mesh_named("pumpkin-1753.ply")
    bodies = make_bodies([[0, 0, 0], [1, 0, 0], [2, 0, 0]], np.eye(3))
    two = np.array([[0, 1], [0, 2]])
    for ignored, said in ((two[:0], ""), (two[:1], "the one that is ignored"), (two, "the 2 that are ignored")):
        scene = Scene(
            "mesh", (cube, pumpkin), bodies, Box(np.full(3, 9.0)), mesh_of=np.array([0, 1, 1]), ignored=ignored
        )
        for algorithm in ("brute-force", "grid", "predictive"):
            why = stages(scene, algorithm)["pairs"].why
            assert why.endswith(f", but for {said}") if said else "ignored" not in why
        law = MotionLaw(1.0, 0.1, "none")
        for query in ("distance", "impact"):
            method = method_of(MethodName("fcl", "grid", "mesh", query), within=0.1 if query == "distance" else None)
            of_query = {stage.name: stage.why for stage in method.plan(scene, law).stages}
            assert of_query["pairs"].endswith(f", but for {said}") if said else "ignored" not in of_query["pairs"]
            if query == "distance":
                assert f"hulls (8 to {len(pumpkin.hull.vertices)} vertices)" in of_query["hull_gap"]
                assert "surfaces of 12 to 1753 faces" in of_query["surface_gap"]


def test_a_digest_tells_two_sequences_of_hits_apart():
    scene = random_scene("sphere", 12, 3.0)
    (_, one), (_, same), (_, other) = fly(scene), fly(scene), fly(scene, frames=39)
    assert one.metrics["event_digest"] == same.metrics["event_digest"] != other.metrics["event_digest"]
    assert one.metrics["event_digest"] == int(one.metrics["event_digest"]) <= 2**52
