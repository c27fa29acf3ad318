"""The plan that is printed is what is loaded: with a stage put the other way, the pipeline does otherwise."""

from dataclasses import replace

import numpy as np
import pytest

from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.broadphase.uniform_grid import UniformGrid
from harness.methods import culled, narrow_phase, observer, penetration, predictive, stepping
from harness.methods.stages import Plan, Stage, StageError
from harness.motion import kinematics
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from tests.conftest import random_scene
from tests.methods.flights import method_for
from tests.narrowphase.meshes import mesh_named

FRAMES, DT = 6, 0.05


def law(response="reflect"):
    return MotionLaw(FRAMES * DT, DT, response)


def crowd(shape, ratio=1.0, spin=1.0, speed=1.0):
    scene = random_scene(shape, 12, 1.8, seed=7)
    bodies = replace(
        scene.bodies,
        sizes=np.linspace(1.0, 1.0 / ratio, 12),
        spins=scene.bodies.spins * spin,
        velocities=scene.bodies.velocities * speed,
    )
    mesh = mesh_named("pumpkin-1753.ply") if shape == "mesh" else scene.mesh
    return Scene(shape, (mesh,), bodies, scene.box)


class Calls:
    """Counts the calls of functions of the program while it flies."""

    def __init__(self, patch):
        self.patch, self.counts = patch, {}

    def count(self, owner, name, key, when=lambda *_: True):
        called = getattr(owner, name)

        def counted(*arguments, **more):
            self.counts[key] = self.counts.get(key, 0) + bool(when(*arguments))
            return called(*arguments, **more)

        self.patch.setattr(owner, name, counted)

    def __getitem__(self, key):
        return self.counts.get(key, 0)


@pytest.fixture
def calls(monkeypatch):
    made = Calls(monkeypatch)
    made.count(kinematics, "turn", "orientations")
    made.count(culled.CloseSpheres, "pairs", "frames")
    made.count(culled.CulledDetector, "pairs", "frames")
    made.count(HierarchicalGrid, "size_classes", "size_classes")
    made.count(narrow_phase.HullPairs, "settle", "hull_axis")
    made.count(narrow_phase.MeshPairs, "settle", "crossing")
    made.count(narrow_phase.Containment, "contained", "containment")
    made.count(narrow_phase.FclPairTest, "__init__", "fcl")
    made.count(stepping.CollisionResponse, "pairs", "response")
    made.count(stepping.CollisionResponse, "walls", "walls")
    made.count(stepping, "hulls_at_walls", "wall_cull", lambda *arguments: arguments[5])
    made.count(penetration.Penetration, "deepest", "penetration")
    made.count(stepping.CourseLog, "turn", "recording")
    return made


def flipped(plan, name):
    """The same plan with one stage the other way, whatever that does to the answer."""
    stages = [replace(stage, kept=not stage.kept) if stage.name == name else stage for stage in plan.stages]
    return Plan(tuple(stages), plan.warnings)


SEEN = ("orientations", "size_classes", "hull_axis", "crossing", "containment", "fcl", "response", "walls", "wall_cull")


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@pytest.mark.parametrize("recorded", [False, True])
def test_what_a_stepped_plan_keeps_is_called_and_what_it_leaves_out_is_not(shape, recorded, calls):
    scene = crowd(shape, ratio=4.0 if shape != "hull" else 1.0)
    method = method_for(scene, "grid")
    plan = method.plan(scene, law(), recorded=recorded)
    calls.counts.clear()  # of planning
    outcome = method.load(scene, plan).fly(law())
    for name in (*SEEN, "penetration", "recording"):
        assert (calls[name] > 0) == plan.keeps(name), name
    assert calls["frames"] == FRAMES
    assert (outcome.course is not None) == recorded


FREE = [
    ("hull", "orientations", {"spin": 0.0}),
    ("sphere", "orientations", {}),
    ("sphere", "size_classes", {"ratio": 4.0}),
    ("sphere", "size_classes", {}),
    ("hull", "hull_axis", {}),
    ("mesh", "hull_axis", {}),
    ("mesh", "crossing", {}),
    ("mesh", "containment", {}),
    ("hull", "wall_cull", {}),
    ("hull", "penetration", {}),
    ("sphere", "penetration", {}),
]


@pytest.mark.parametrize(("shape", "name", "scene"), FREE)
def test_a_stage_that_is_forced_the_other_way_changes_what_is_called(shape, name, scene, calls):
    scene = crowd(shape, **scene)
    plan = method_for(scene, "grid").plan(scene, law())
    forced = method_for(scene, "grid", forced={name: not plan.keeps(name)})
    other = forced.plan(scene, law())
    assert other.keeps(name) != plan.keeps(name)
    assert "forced" in next(stage.why for stage in other.stages if stage.name == name)
    calls.counts.clear()  # of planning
    forced.load(scene, other).fly(law())
    assert (calls[name] > 0) == other.keeps(name)


def test_bodies_at_rest_are_looked_at_once_unless_motion_is_forced_on(calls):
    scene = crowd("sphere", speed=0.0)
    method = method_for(scene, "grid", forced={"pairs": True})
    method.load(scene, method.plan(scene, law())).fly(law())
    once = calls["frames"]
    moving = method_for(scene, "grid", forced={"pairs": True, "motion": True})
    moving.load(scene, moving.plan(scene, law())).fly(law())
    assert once < calls["frames"] - once == FRAMES


def test_pairs_that_cannot_meet_are_not_looked_for_unless_forced(calls):
    scene = Scene("sphere", (), crowd("sphere").bodies, crowd("sphere").box)
    far = replace(
        scene,
        bodies=replace(scene.bodies, positions=scene.bodies.positions * 1e3, velocities=scene.bodies.velocities * 1e-9),
    )
    for forced in ({}, {"pairs": True}):
        method = method_for(far, "grid", forced=forced)
        plan = method.plan(far, law())
        method.load(far, plan).fly(law())
        assert plan.keeps("pairs") == bool(forced) == (calls["frames"] > 0)


@pytest.mark.parametrize("algorithm", ["brute-force", "grid", "tree", "predictive"])
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@pytest.mark.parametrize("recorded", [False, True])
def test_every_stage_of_every_plan_is_forced_or_refused_with_a_reason(algorithm, shape, recorded):
    scene = crowd(shape)
    plan = method_for(scene, algorithm).plan(scene, law(), recorded=recorded)
    for stage in plan.stages:
        forced = method_for(scene, algorithm, forced={stage.name: not stage.kept})
        refused = []
        try:
            other = forced.plan(scene, law(), recorded=recorded)
        except StageError as error:
            refused = [name for name, _ in error.refusals]
        assert refused == [stage.name] if refused else other.keeps(stage.name) != stage.kept


def test_the_grid_of_a_plan_is_the_one_that_is_made():
    scene = crowd("sphere", ratio=4.0)
    method = method_for(scene, "grid")
    plan = method.plan(scene, law())
    assert type(method.broad_phase(scene, plan)) is HierarchicalGrid
    assert type(method.broad_phase(scene, flipped(plan, "size_classes"))) is UniformGrid


@pytest.mark.parametrize(
    ("shape", "name", "found", "values"),
    [
        ("sphere", "neighbour_lists", lambda made: made.search, ("cells", "lists")),
        ("mesh", "mesh_search", lambda made: made._solid.body.concave, (True, False)),
        ("mesh", "contact_end", lambda made: made._solid.body.shapes.field.values.size > 0, (False, True)),
    ],
)
def test_an_event_driven_pipeline_is_what_its_plan_says(shape, name, found, values, monkeypatch):
    """Put the other way, these stages would change digits of a hit's time, so that nobody may force them; but the plan
    alone decides on them."""
    scene = crowd(shape)
    method = method_for(scene, "predictive")
    plan = method.plan(scene, law())
    made = []
    for kind in ("Simulation", "SolidSimulation"):
        original = getattr(predictive, kind)
        monkeypatch.setattr(predictive, kind, lambda *a, _kind=original, **k: made.append(_kind(*a, **k)) or made[-1])
    for one in (plan, flipped(plan, name)):
        method.load(scene, one).fly(MotionLaw(0.01, 0.01, "reflect"))
    assert tuple(found(one) for one in made) == values


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull"])
@pytest.mark.parametrize("recorded", [False, True])
def test_an_event_driven_run_is_recorded_and_measured_as_planned(shape, recorded, calls):
    scene = crowd(shape)
    for forced in ({}, {"penetration": False}):
        method = method_for(scene, "predictive", forced=forced)
        plan = method.plan(scene, law(), recorded=recorded)
        outcome = method.load(scene, plan).fly(law())
        assert plan.keeps("recording") == recorded == (outcome.course is not None)
        assert plan.keeps("penetration") == (not forced) == ("max_penetration" in outcome.metrics)


def test_a_plan_keeps_what_its_stages_say():
    plan = Plan((Stage("walls", True, ""), Stage("pairs", False, "")))
    assert plan.kept == {"walls"}
    assert not plan.keeps("pairs")
    assert observer.Observer  # the watcher of stepped runs is a part of the methods
