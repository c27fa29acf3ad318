"""The plan of a run: which stages its scene needs, which it does not, and why.

A pipeline is assembled from the plan, not switched on inside loops. Leaving a stage out never changes an event; where
it would, the stage stays, and an experiment that forces it off (`engine.stages`) is refused. `brute-force` leaves
nothing of detection out, and of a backend's own pipeline (`native`) nothing is known that could be left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

from harness.backends.detection import NAMES, decide_detection, equal_sizes
from harness.backends.stages import Decisions, Stage
from harness.motion.predictive.solids import needs_its_surface
from harness.motion.reach import nobody_meets, nobody_moves, walls_are_out_of_reach
from harness.scene.scene import Scene
from harness.vocabulary import Response


@dataclass(frozen=True)
class Plan:
    """What a run will do, in order, and what its user should be warned of."""

    stages: tuple[Stage, ...]
    warnings: tuple[str, ...] = ()

    def keeps(self, name: str) -> bool:
        """Whether there is a stage of this name, and it is kept."""
        return any(stage.kept for stage in self.stages if stage.name == name)


@dataclass(frozen=True)
class Asked:
    """What the plan is for: a scene, and how it is to be flown."""

    scene: Scene
    backend: str
    algorithm: str
    response: Response
    duration: float

    @property
    def thorough(self) -> bool:
        """Whether every pair and every wall is to be put to the test, needed or not."""
        return self.algorithm == "brute-force"

    @property
    def ours(self) -> bool:
        """Whether the stages of detection are known, so that one can be left out."""
        return self.algorithm in ("grid", "tree")


def make_plan(
    scene: Scene,
    *,
    backend: str,
    algorithm: str,
    response: Response,
    duration: float = inf,
    approximated: str | None = None,
    forced: Mapping[str, bool] | None = None,
) -> Plan:
    """The plan for a run.

    Parameters
    ----------
    scene : Scene
    backend, algorithm : as in `engine`
    response : {"reflect", "elastic", "none"}
    duration : s that are flown; what is out of reach for so long is not tested
    approximated : how the backend replaces the scene's shape by another, if it does
    forced : stages forced on (True) or off (False) for an ablation

    Raises
    ------
    StageError
        If a forced stage does not exist, or forcing it would change the result.
    """
    asked, decisions = Asked(scene, backend, algorithm, response, duration), Decisions(forced)
    if algorithm == "predictive":
        _scheduled(asked, decisions)
    else:
        _motion(asked, decisions)
        _orientations(asked, decisions)
        pairs = _pairs(asked, decisions)
        _response(asked, pairs, decisions)
        _walls(asked, pairs, decisions)
    _penetration(scene, decisions)
    decisions.take("recording", False, "nothing asks for recorded poses", fixed="there is nothing to record for")
    warnings = (f"APPROXIMATION: {approximated}",) if approximated else ()
    return Plan(decisions.finish(), warnings)


def _motion(asked: Asked, decisions: Decisions) -> None:
    if not nobody_moves(asked.scene):
        fixed = "bodies move"
        decisions.take("motion", True, "bodies move: every frame places them and looks anew", fixed=fixed)
    elif asked.ours:
        why = "nobody moves: bodies are placed once and their pairs found once, for all frames"
        decisions.take("motion", False, why)
    else:
        who = "brute force" if asked.thorough else asked.backend
        why = f"nobody moves, but {who} is asked about every frame"
        decisions.take("motion", True, why, fixed="only grid and tree may be asked once for all frames")


def _orientations(asked: Asked, decisions: Decisions) -> None:
    if asked.scene.shape == "sphere":
        decisions.take("orientations", False, "a sphere looks the same however it is turned")
    elif not asked.scene.bodies.spins.any():
        decisions.take("orientations", False, "no body spins, so each keeps the orientation it starts with")
    else:
        why = "bodies spin, and their shape is not a sphere"
        decisions.take("orientations", True, why, fixed=why)


def _pairs(asked: Asked, decisions: Decisions) -> bool:
    """Whether pairs are tested at all, and by which stages."""
    count = len(asked.scene.bodies)
    if count < 2:
        why = f"there is no pair of bodies among {count}"
        _no_detection(why, decisions, fixed=why)
        return False
    if asked.ours and nobody_meets(asked.scene, asked.duration):
        why = f"no two of {count} bodies can meet in {asked.duration:g} s at their speeds"
        if not decisions.take("pairs", False, why):
            _no_detection(why, decisions, fixed="no pair is tested; keep pairs", pairs=False)
            return False
    else:
        how = {
            "brute-force": f"brute force: all {count * (count - 1) // 2} pairs are put to {asked.backend} every frame",
            "native": f"{asked.backend} finds the touching pairs by itself",
        }
        why = how.get(asked.algorithm, f"{asked.algorithm} finds the touching pairs")
        decisions.take("pairs", True, why, fixed="hits would be missed")
    if asked.ours or asked.thorough:
        decide_detection(asked.scene, asked.algorithm, decisions)
    return True


def _no_detection(why: str, decisions: Decisions, *, fixed: str, pairs: bool = True) -> None:
    for name in ("pairs", *NAMES) if pairs else NAMES:
        decisions.take(name, False, why, fixed=fixed)


def _response(asked: Asked, pairs: bool, decisions: Decisions) -> None:
    if asked.response == "none":
        why = "response is none: bodies pass through each other"
        decisions.take("response", False, why, fixed="response is none")
    elif not pairs:
        decisions.take("response", False, "no two bodies meet", fixed="there is nothing to answer")
    else:
        why = f"touching pairs that approach are answered ({asked.response})"
        decisions.take("response", True, why, fixed="hits would not be answered; choose response none for that")


def _walls(asked: Asked, pairs: bool, decisions: Decisions) -> None:
    scene = asked.scene
    if asked.response == "none":
        why = "response is none: the box folds the path of each bounding sphere exactly"
        kept = decisions.take("walls", False, why, fixed="nothing would answer them")
    elif not len(scene.bodies):
        kept = decisions.take("walls", False, "there is no body", fixed="there is nothing to test")
    elif not asked.thorough and walls_are_out_of_reach(scene, asked.duration, asked.response, alone=not pairs):
        kept = decisions.take("walls", False, f"no body can get to a wall in {asked.duration:g} s")
    else:
        shapes = "spheres" if scene.shape == "sphere" else "the support function of the hull"
        why = f"each body against six walls, by {shapes}"
        kept = decisions.take("walls", True, why, fixed="bodies would leave the box")
    if not kept:
        decisions.take("wall_cull", False, "no wall is tested", fixed="no wall is tested")
    elif scene.shape == "sphere":
        why = "the bounding sphere is the body itself"
        decisions.take("wall_cull", False, why, fixed=why)
    elif asked.thorough:
        why = "brute force puts the hull of every body to every wall"
        decisions.take("wall_cull", False, why, fixed="brute force leaves nothing out; choose algorithm grid")
    else:
        decisions.take("wall_cull", True, "a body whose bounding sphere reaches no wall needs no support function")


def _penetration(scene: Scene, decisions: Decisions) -> None:
    if scene.shape == "mesh":
        why = "a mesh is a surface: its depth of overlap is not defined"
        decisions.take("penetration", False, why, fixed=why)
    elif len(scene.bodies) < 2:
        decisions.take("penetration", False, "no two bodies can overlap", fixed="no two bodies can overlap")
    else:
        decisions.take("penetration", True, "max_penetration is measured on touching pairs, outside every clock")


_SCHEDULED = "event-driven motion has no stage to force"


def _scheduled(asked: Asked, decisions: Decisions) -> None:
    """The stages of event-driven motion."""
    scene, count = asked.scene, len(asked.scene.bodies)
    solid, alone = scene.shape != "sphere", f"there is no pair of bodies among {count}"
    grids = "cells of one size" if equal_sizes(scene) else "a hierarchy of cells, one level a size class"

    def take(name: str, kept: bool, why: str) -> None:
        decisions.take(name, kept, why, fixed=_SCHEDULED)

    take("frames", False, "events are computed, not stepped to")
    if solid:
        take("orientations", True, "bodies are turned where a contact is searched, and nowhere else")
        take("backend", False, "contacts are searched by conservative advancement; no library is asked")
        found = f"from when to when each body's bounding sphere overlaps its neighbours', found by {grids}"
    else:
        take("orientations", False, "a sphere looks the same however it is turned")
        take("backend", False, "spheres are solved in closed form; no library is asked")
        found = f"the next hit of each body among its neighbours, from {grids} or from lists when dense"
    take("pairs", count > 1, found if count > 1 else alone)
    if solid:
        hulls = "hulls are advanced to their contact when their spheres meet, not before"
        take("hull_search", count > 1, hulls if count > 1 else alone)
        surfaces = "surfaces are advanced to their contact when their hulls meet, not before"
        if scene.shape == "hull":
            take("mesh_search", False, "the shape is the hull")
        elif count > 1 and not needs_its_surface(scene):
            why = "the mesh is convex, its own hull, and no body can be inside an equal one"
            take("mesh_search", False, why)
        else:
            take("mesh_search", count > 1, surfaces if count > 1 else alone)
    take("walls", True, "the next wall of each body, from its velocity")
    if solid and asked.response == "none":
        take("wall_search", False, "response is none: the box folds the path of each bounding sphere exactly")
    elif solid:
        take("wall_search", True, "the support function of the hull, once a bounding sphere meets the wall")
