"""Methods that step from frame to frame: what their plans have in common, and how the plan becomes a pipeline.

A frame moves the bodies, finds all touching pairs, answers them, then the walls. How the pairs are found is each
method's own (`detector`); everything around it is decided and assembled here.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from functools import partial
from typing import ClassVar

from harness.arrays import Floats, Pairs
from harness.backends.poses import near_radii
from harness.broadphase.all_pairs import AllPairs
from harness.broadphase.ignored import asked_about
from harness.broadphase.pairs import BroadPhase
from harness.methods.ill_posed import ill_posed
from harness.methods.impact_times import ImpactFinder, KernelImpacts
from harness.methods.method import Method, Pipeline, WarmUp
from harness.methods.near_pairs import KernelNearPairs, NearFinder
from harness.methods.query_pipelines import ImpactPipeline, NearPipeline
from harness.methods.stages import Decisions, Plan
from harness.methods.stepping import Detector, Stepping
from harness.methods.warm_up_scene import RESPONSES, TOUCHING, of_meshes, two_bodies
from harness.motion.law import MotionLaw
from harness.motion.reach import all_at_rest, no_pair_can_meet, walls_are_out_of_reach
from harness.scene.scene import Scene
from harness.vocabulary import NEAR_QUERIES, QUERIES, Shape


class SteppedMethod(Method):
    """A method that steps from frame to frame.

    Attributes
    ----------
    leaves_out : whether its stages of detection are known, so that one that a scene does not need is left out
    tests_everything : whether every pair and every wall is put to the test in every frame, needed or not
    """

    leaves_out: ClassVar[bool] = False
    tests_everything: ClassVar[bool] = False

    @abstractmethod
    def finding(self, count: int) -> str:
        """How the touching pairs of so many bodies are found, in a sentence of a plan."""

    @abstractmethod
    def detector(self, scene: Scene, plan: Plan) -> Detector:
        """A detector of the stages of detection that the plan keeps, loaded with the scene.

        Raises
        ------
        InputError
            If the library that it stands on is missing, or cannot hold the scene.
        """

    def decide_cull(self, scene: Scene, near: str, decisions: Decisions) -> None:
        """Decide on the stages that find the pairs for which `near` holds, such as "whose spheres touch".

        Of queries other than collision; without any, nothing of them is known.
        """

    def close_pairs_of(self, scene: Scene, plan: Plan, radii: Floats) -> BroadPhase:
        """A broad phase for spheres of these radii (n,) m around the bodies of a scene; for the same queries."""
        return AllPairs(len(scene.bodies))

    def near_finder(self, scene: Scene, plan: Plan) -> NearFinder:
        """What finds near pairs, loaded with the scene.

        Raises
        ------
        InputError
            If the library that it stands on is missing, or cannot hold the scene, or has no such query.
        """
        within, query = self.within or 0.0, self.name.query
        close_pairs = asked_about(
            self.close_pairs_of(scene, plan, near_radii(scene.enclosing_radii, within)), scene.ignored
        )
        return KernelNearPairs(scene, close_pairs, query, within, self.tolerance)

    def impact_finder(self, scene: Scene, plan: Plan) -> ImpactFinder:
        """What finds impacts, loaded with the scene; raises as `near_finder` does."""

        def make(radii: Floats) -> BroadPhase:
            return asked_about(self.close_pairs_of(scene, plan, radii), scene.ignored)

        return KernelImpacts(scene, make, self.tolerance)

    def decide_detection(self, scene: Scene, decisions: Decisions) -> None:
        """Decide on the stages of detection; without any, nothing of it is known."""

    def no_detection(self, why: str, decisions: Decisions, *, fixed: str) -> None:
        """Leave out all stages of detection."""

    def warnings(self, scene: Scene) -> tuple[str, ...]:
        """What a user should be warned of, such as an approximation."""
        return ()

    def detection(self, scene: Scene) -> Plan:
        """The plan of detection alone, for a scene whose poses come from elsewhere."""
        decisions = Decisions()
        self.decide_detection(scene, decisions)
        return decisions.finish(self.warnings(scene))

    def plan(self, scene: Scene, law: MotionLaw, *, recorded: bool = False) -> Plan:
        decisions, flown = Decisions(self.forced), law.frames * law.dt
        self._decide_motion(scene, decisions)
        _decide_orientations(scene, decisions)
        pairs = self._decide_pairs(scene, flown, decisions)
        _decide_response(scene, law, pairs, decisions)
        self._decide_walls(scene, law, flown, pairs, decisions)
        if self.name.query == "collision":
            decide_penetration(scene, decisions)
        else:
            why = f"query {self.name.query} does not ask how deep bodies are in each other"
            decisions.take("penetration", False, why, fixed=why)
        decide_recording(recorded, decisions)
        return decisions.finish((*self.warnings(scene), *ill_posed(scene, law)))

    def load(self, scene: Scene, plan: Plan) -> Pipeline:
        pairs = plan.keeps("pairs")
        if self.name.query in NEAR_QUERIES:
            finder = self.near_finder(scene, plan) if pairs else None
            return NearPipeline(scene, plan, finder, gaps=self.name.query == "distance")
        if self.name.query == "impact":
            return ImpactPipeline(scene, plan, self.impact_finder(scene, plan) if pairs else None)
        return Stepping(scene, plan, self.detector(scene, plan) if pairs else None)

    def warm_ups(self, meshes: int = 1) -> Iterator[WarmUp]:
        if self.name.query != "collision":
            what = f"{self.name.query} of {self.name.shape}s by {self.name.algorithm}{of_meshes(meshes)}"
            yield what, partial(_ask_frames, self, meshes)
            return
        shape: Shape = "sphere" if self.name.shape == "sphere" else "hull"
        yield f"frames of {shape}s{of_meshes(meshes)}", partial(_fly_frames, shape, meshes)

    def _decide_motion(self, scene: Scene, decisions: Decisions) -> None:
        if scene.poses is not None:
            why = f"poses are recorded: every frame takes those of {scene.poses.name}"
            decisions.take("motion", True, why, fixed="poses are recorded")
        elif not all_at_rest(scene):
            fixed = "bodies move"
            decisions.take(
                "motion", True, "bodies move: every frame places them and finds their pairs anew", fixed=fixed
            )
        elif self.leaves_out:
            why = "no body moves: bodies are placed once and their pairs found once, for all frames"
            decisions.take("motion", False, why)
        else:
            who = "brute force" if self.tests_everything else self.name.backend
            why = f"no body moves, but {who} is asked about every frame"
            decisions.take(
                "motion",
                True,
                why,
                fixed="it may be asked once for all frames only where its stages are known",
            )

    def _decide_pairs(self, scene: Scene, flown: float, decisions: Decisions) -> bool:
        """Whether pairs are tested at all, and by which stages."""
        count = len(scene.bodies)
        if count < 2:
            why = f"there is no pair of bodies among {count}"
            decisions.take("pairs", False, why, fixed=why)
            self.no_detection(why, decisions, fixed=why)
            return False
        less = but_for_the_ignored(scene)
        if self.leaves_out and scene.poses is None and no_pair_can_meet(scene, flown, self.within or 0.0):
            met = f"come within {self.within:g} m" if self.within else "meet"
            why = f"no two of {count} bodies can {met} in {flown:g} s at their speeds"
            if not decisions.take("pairs", False, why):
                self.no_detection(why, decisions, fixed="no pair is tested; keep pairs")
                return False
        elif self.name.query == "collision":
            decisions.take("pairs", True, f"{self.finding(count)}{less}", fixed="hits would be missed")
        else:
            asked = QUERIES[self.name.query].replace("`within`", f"{self.within or 0.0:g} m")
            why = f"{self.name.query}: {asked}{less}"
            decisions.take("pairs", True, why, fixed="the question would go unanswered")
        if self.name.query == "collision":
            self.decide_detection(scene, decisions)
        else:
            near = f"come within {self.within:g} m" if self.within else "may touch on the way to the next frame"
            self.decide_cull(scene, near, decisions)
        return True

    def _decide_walls(self, scene: Scene, law: MotionLaw, flown: float, pairs: bool, decisions: Decisions) -> None:
        everything = self.tests_everything
        if scene.poses is not None:
            kept = decisions.take("walls", False, "poses are recorded: there are no walls", fixed="there are no walls")
        elif law.response == "none":
            why = "response is none: the box folds the path of each bounding sphere exactly"
            kept = decisions.take("walls", False, why, fixed="nothing would answer them")
        elif not len(scene.bodies):
            kept = decisions.take("walls", False, "there is no body", fixed="there is nothing to test")
        elif not everything and walls_are_out_of_reach(scene, flown, law.response, no_pairs=not pairs):
            kept = decisions.take("walls", False, f"no body can get to a wall in {flown:g} s")
        else:
            shapes = "spheres" if scene.shape == "sphere" else "the support function of the hull"
            why = f"each body against six walls, by {shapes}"
            kept = decisions.take("walls", True, why, fixed="bodies would leave the box")
        if not kept:
            decisions.take("wall_cull", False, "no wall is tested", fixed="no wall is tested")
        elif scene.shape == "sphere":
            why = "the bounding sphere is the body itself"
            decisions.take("wall_cull", False, why, fixed=why)
        elif everything:
            why = "brute force puts the hull of every body to every wall"
            decisions.take("wall_cull", False, why, fixed="brute force leaves nothing out; choose algorithm grid")
        else:
            decisions.take("wall_cull", True, "a body whose bounding sphere reaches no wall needs no support function")


def but_for_the_ignored(scene: Scene) -> str:
    """What a sentence about all pairs must add where a scene has pairs that are never asked about."""
    count = len(scene.ignored)
    if not count:
        return ""
    return f", but for the {count} that are ignored" if count > 1 else ", but for the one that is ignored"


def decide_penetration(scene: Scene, decisions: Decisions) -> None:
    """Whether the depth of overlaps is measured; for any method."""
    if scene.shape == "mesh":
        why = "a mesh is a surface: its depth of overlap is not defined"
        decisions.take("penetration", False, why, fixed=why)
    elif len(scene.bodies) < 2:
        decisions.take("penetration", False, "no two bodies can overlap", fixed="no two bodies can overlap")
    else:
        decisions.take("penetration", True, "max_penetration is measured on touching pairs, outside every clock")


def decide_recording(recorded: bool, decisions: Decisions) -> None:
    """Whether the course of every body is kept; for any method."""
    if recorded:
        why = "a replay or a trace is made of this run: the course of every body is kept"
        decisions.take("recording", True, why, fixed="nothing would be kept")
    else:
        decisions.take("recording", False, "nothing asks for recorded poses", fixed="there is nothing to record for")


def _decide_orientations(scene: Scene, decisions: Decisions) -> None:
    if scene.shape == "sphere":
        decisions.take("orientations", False, "a sphere looks the same however it is turned")
    elif scene.poses is not None:
        decisions.take("orientations", True, "poses are recorded", fixed="poses are recorded")
    elif not scene.bodies.spins.any():
        decisions.take("orientations", False, "no body spins, so each keeps the orientation it starts with")
    else:
        why = "bodies spin, and their shape is not a sphere"
        decisions.take("orientations", True, why, fixed=why)


def _decide_response(scene: Scene, law: MotionLaw, pairs: bool, decisions: Decisions) -> None:
    if scene.poses is not None:
        decisions.take("response", False, "poses are recorded: nothing answers a hit", fixed="poses are recorded")
    elif law.response == "none":
        why = "response is none: bodies pass through each other"
        decisions.take("response", False, why, fixed="response is none")
    elif not pairs:
        decisions.take("response", False, "no two bodies meet", fixed="there is nothing to answer")
    else:
        why = f"touching pairs that approach are answered ({law.response})"
        decisions.take("response", True, why, fixed="hits would not be answered; choose response none for that")


def _ask_frames(method: SteppedMethod, meshes: int) -> None:
    """Two frames of two bodies that meet, by the method as it is."""
    scene, dt = two_bodies(method.name.shape, meshes), 0.3
    law = MotionLaw(2 * dt, dt, "none")
    method.load(scene, method.plan(scene, law)).fly(law, traced=True)


class _AlwaysTouching:
    """A detector for the warm-up, which compiles only what is around it: the two bodies always touch."""

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return TOUCHING


def _fly_frames(shape: Shape, meshes: int) -> None:
    """Two frames with every response; every stage that a detector is not asked for is kept."""
    scene, dt = two_bodies(shape, meshes), 0.3
    for response in RESPONSES:
        law = MotionLaw(2 * dt, dt, response)
        decisions = Decisions()
        decisions.take("motion", True, "")
        _decide_orientations(scene, decisions)
        decisions.take("pairs", True, "")
        _decide_response(scene, law, True, decisions)
        decisions.take("walls", response != "none", "")
        decisions.take("wall_cull", shape != "sphere", "")
        decide_penetration(scene, decisions)
        Stepping(scene, decisions.finish(), _AlwaysTouching()).fly(law)
