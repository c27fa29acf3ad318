"""The stages of detection of queries other than collision: those that kernels have, and those that only it needs."""

from __future__ import annotations

from harness.methods.stages import Decisions, span_of
from harness.scene.scene import Scene
from harness.vocabulary import NEAR_QUERIES, Query

# What settles whether pairs touch, and nothing else.
_OF_COLLISION = ("hull_axis", "crossing", "fcl", "containment")


def decide_exact_stages(query: Query, scene: Scene, decisions: Decisions) -> None:
    """The stages that follow the cull, where kernels answer; whether pairs touch is not asked by itself."""
    for stage in _OF_COLLISION:
        decisions.take(stage, False, _NOT_NEEDED[stage], fixed=_NOT_NEEDED[stage])
    if query in NEAR_QUERIES:
        _decide_gaps(query, scene, decisions)
    else:
        _decide_impacts(scene, decisions)


_NOT_NEEDED = {
    "hull_axis": "it settles whether pairs touch, which this query does not ask",
    "crossing": "it settles whether surfaces cross, which this query does not ask",
    "fcl": "kernels leave nothing open of this query: no library is asked",
    "containment": "a surface inside another is as far from it as any other",
}


def _decide_gaps(query: Query, scene: Scene, decisions: Decisions) -> None:
    vertices = span_of([len(mesh.hull.vertices) for mesh in scene.meshes])
    faces = span_of([len(mesh.faces) for mesh in scene.meshes])
    known = "until it is known to be wider or not" if query == "tolerance" else "down to tolerance"
    lost = "there would be no gap"
    if scene.shape == "sphere":
        decisions.take("hull_gap", False, "the gap of spheres is that of their centres less their radii", fixed=lost)
        decisions.take("surface_gap", False, "a sphere has no surface of triangles", fixed=lost)
    elif scene.shape == "hull":
        found = f"the gap of two hulls of {vertices} vertices by GJK, {known}, from the simplex of the last frame"
        decisions.take("hull_gap", True, found, fixed=lost)
        decisions.take("surface_gap", False, "the shape is the hull", fixed="the shape is the hull")
    else:
        why = f"only pairs whose hulls ({vertices} vertices) may be near go on, by GJK"
        decisions.take("hull_gap", True, why, fixed="the search of surfaces begins with it")
        found = f"the gap of two surfaces of {faces} faces by a descent of both trees, {known}"
        decisions.take("surface_gap", True, f"{found}, from the nearest triangles of the last frame", fixed=lost)


def _decide_impacts(scene: Scene, decisions: Decisions) -> None:
    lost = "hits would be missed"
    if scene.shape == "sphere":
        solved = "when spheres touch is solved in closed form"
        for stage in ("hull_search", "mesh_search", "contact_end"):
            decisions.take(stage, False, solved, fixed=solved)
        return
    why = "hulls are advanced to their contact, from where their spheres meet"
    decisions.take("hull_search", True, why, fixed=lost)
    if scene.shape == "hull":
        decisions.take("mesh_search", False, "the shape is the hull", fixed="the shape is the hull")
    else:
        why = "surfaces are advanced to their contact, from where their hulls meet"
        decisions.take("mesh_search", True, why, fixed=lost)
    why = "a pair that touches is followed until it parts, for only then can it begin to touch again"
    decisions.take("contact_end", True, why, fixed=lost)
