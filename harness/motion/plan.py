"""The plan of a run: which stages its scene needs, which it does not, and why.

A pipeline is assembled from the plan, not switched on inside loops. Leaving a stage out never changes an event; where
it would, the stage stays, and an experiment that forces it off (`engine.stages`) is refused.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.errors import InputError
from harness.motion.predictive.solids import needs_its_surface
from harness.motion.response import Response
from harness.scene.scene import Scene


@dataclass(frozen=True)
class Stage:
    """One stage of the pipeline: kept or left out, and why."""

    name: str
    kept: bool
    why: str


@dataclass(frozen=True)
class Plan:
    """What a run will do, in order, and what its user should be warned of."""

    stages: tuple[Stage, ...]
    warnings: tuple[str, ...] = ()

    def keeps(self, name: str) -> bool:
        """Whether the stage of this name is kept."""
        return next(stage.kept for stage in self.stages if stage.name == name)


def make_plan(
    scene: Scene,
    *,
    backend: str,
    algorithm: str,
    response: Response,
    approximated: str | None = None,
    forced: Mapping[str, bool] | None = None,
) -> Plan:
    """The plan for a run.

    Parameters
    ----------
    scene : Scene
    backend, algorithm : as in `engine`
    response : {"reflect", "elastic", "none"}
    approximated : how the backend replaces the scene's shape by another, if it does
    forced : stages forced on (True) or off (False) for an ablation

    Raises
    ------
    InputError
        If a forced stage does not exist, or forcing it would change the result.
    """
    if algorithm == "predictive":
        stages = [_orientations(scene), *_scheduled(scene, response)]
    else:
        stages = [
            _orientations(scene),
            _pairs(scene, backend, algorithm),
            _response(scene, response),
            _walls(scene, response),
            _wall_cull(scene, algorithm, response),
        ]
    stages += [_penetration(scene), Stage("recording", False, "nothing asks for recorded poses")]
    stages = _force(stages, forced or {})
    warnings = (f"APPROXIMATION: {approximated}",) if approximated else ()
    return Plan(tuple(stages), warnings)


def _orientations(scene: Scene) -> Stage:
    if scene.shape == "sphere":
        return Stage("orientations", False, "a sphere looks the same however it is turned")
    if not scene.bodies.spins.any():
        return Stage("orientations", False, "no body spins, so each keeps the orientation it starts with")
    return Stage("orientations", True, "bodies spin, and their shape is not a sphere")


def _pairs(scene: Scene, backend: str, algorithm: str) -> Stage:
    count = len(scene.bodies)
    if count < 2:
        return Stage("pairs", False, f"there is no pair of bodies among {count}")
    if algorithm == "brute-force":
        pairs = count * (count - 1) // 2
        return Stage("pairs", True, f"brute force: all {pairs} pairs are put to {backend} every frame")
    return Stage("pairs", True, f"{algorithm} on {backend} finds the touching pairs among {count} bodies")


def _scheduled(scene: Scene, response: Response) -> list[Stage]:
    sizes = scene.bodies.sizes
    if scene.shape != "sphere":
        return _scheduled_solids(scene, response)
    if len(sizes) < 2:
        return [Stage("pairs", False, f"there is no pair of bodies among {len(sizes)}"), Stage("walls", True, _FOLDS)]
    grids = "cells of one size" if sizes.min() == sizes.max() else "a hierarchy of cells, one level a size class"
    return [
        Stage("frames", False, "events are computed, not stepped to"),
        Stage("backend", False, "spheres are solved in closed form; no library is asked"),
        Stage("pairs", True, f"the next hit of each body among its neighbours, from {grids} or from lists when dense"),
        Stage("walls", True, _FOLDS),
    ]


def _scheduled_solids(scene: Scene, response: Response) -> list[Stage]:
    sizes = scene.bodies.sizes
    alone = f"there is no pair of bodies among {len(sizes)}"
    grids = "cells of one size" if np.ptp(sizes) == 0.0 else "a hierarchy of cells, one level a size class"
    pairs = f"from when to when each body's bounding sphere overlaps its neighbours', found by {grids}"
    folds = "response is none: the box folds the path of each bounding sphere exactly"
    stages = [
        Stage("frames", False, "events are computed, not stepped to"),
        Stage("backend", False, "contacts are searched by conservative advancement; no library is asked"),
        Stage("pairs", True, pairs),
        Stage("hull_search", True, "hulls are advanced to their contact when their spheres meet, not before"),
        _mesh_search(scene),
        Stage("walls", True, _FOLDS),
        Stage("wall_search", response != "none", _WALL_SEARCH if response != "none" else folds),
    ]
    if len(sizes) < 2:
        stages[2:5] = [Stage(stage.name, False, alone) for stage in stages[2:5]]
    return stages


def _mesh_search(scene: Scene) -> Stage:
    if scene.shape == "hull":
        return Stage("mesh_search", False, "the shape is the hull")
    if not needs_its_surface(scene):
        return Stage("mesh_search", False, "the mesh is convex, its own hull, and no body can be inside an equal one")
    return Stage("mesh_search", True, "surfaces are advanced to their contact when their hulls meet, not before")


_WALL_SEARCH = "the support function of the hull, once a bounding sphere meets the wall"
_FOLDS = "the next wall of each body, from its velocity"


def _response(scene: Scene, response: Response) -> Stage:
    if response == "none":
        return Stage("response", False, "response is none: bodies pass through each other")
    if len(scene.bodies) < 2:
        return Stage("response", False, "no two bodies can meet")
    return Stage("response", True, f"touching pairs that approach are answered ({response})")


def _walls(scene: Scene, response: Response) -> Stage:
    if response == "none":
        return Stage("walls", False, "response is none: the box folds the path of each bounding sphere exactly")
    if not len(scene.bodies):
        return Stage("walls", False, "there is no body")
    shape = "spheres" if scene.shape == "sphere" else "the support function of the hull"
    return Stage("walls", True, f"each body against six walls, by {shape}")


def _wall_cull(scene: Scene, algorithm: str, response: Response) -> Stage:
    if response == "none":
        return Stage("wall_cull", False, "no wall is tested")
    if scene.shape == "sphere":
        return Stage("wall_cull", False, "the bounding sphere is the body itself")
    if algorithm == "brute-force":
        return Stage("wall_cull", False, "brute force puts the hull of every body to every wall")
    return Stage("wall_cull", True, "a body whose bounding sphere reaches no wall needs no support function")


def _penetration(scene: Scene) -> Stage:
    if scene.shape == "mesh":
        return Stage("penetration", False, "a mesh is a surface: its depth of overlap is not defined")
    if len(scene.bodies) < 2:
        return Stage("penetration", False, "no two bodies can overlap")
    return Stage("penetration", True, "max_penetration is measured on touching pairs, outside every clock")


# What may be forced, since it changes the cost and never an event.
_FORCEABLE = {("orientations", True), ("wall_cull", False), ("penetration", False)}


def _force(stages: list[Stage], forced: Mapping[str, bool]) -> list[Stage]:
    names = [stage.name for stage in stages]
    for name, kept in forced.items():
        if name not in names:
            raise InputError(f'stages: there is no stage "{name}" to force; there are {", ".join(names)}')
        place = names.index(name)
        if stages[place].kept == kept:
            continue
        if (name, kept) not in _FORCEABLE:
            state = "on" if kept else "off"
            raise InputError(f"stages: {name} cannot be forced {state}, since {stages[place].why}")
        stages[place] = Stage(name, kept, "forced by engine.stages")
    return stages
