"""Which stages of FCL's detection a scene needs: from the cull by bounding spheres to the judge, in their order.

Each stage leaves less to the next: the spheres leave pairs that are close, the hulls those whose hulls overlap (for
shape `hull` they decide), the search for a crossing those that it cannot prove to touch or not to, FCL the answer.
"""

from __future__ import annotations

from harness.backends.stages import Decisions
from harness.scene.scene import Scene

NAMES = ("sphere_cull", "size_classes", "hull_axis", "crossing", "fcl", "containment")

_JUDGE = "what the other stages leave open would stay so"


def decide_detection(scene: Scene, algorithm: str, decisions: Decisions) -> None:
    """Decide on all of `NAMES` for the pairs of a scene.

    Parameters
    ----------
    scene : Scene
    algorithm : {"brute-force", "grid", "tree"}
    decisions : Decisions
    """
    if algorithm == "brute-force":
        _brute_force(scene, decisions)
        return
    _sphere_cull(scene, algorithm, decisions)
    if scene.shape == "sphere":
        _spheres(algorithm, decisions)
    else:
        _solids(scene, algorithm, decisions)


def _brute_force(scene: Scene, decisions: Decisions) -> None:
    why, fixed = "brute force puts every pair to FCL", "brute force leaves nothing out; choose algorithm grid"
    for name in NAMES:
        if name == "fcl":
            count = len(scene.bodies)
            every = f"all {count * (count - 1) // 2} pairs are put to FCL every frame"
            decisions.take("fcl", True, every, fixed=_JUDGE)
        else:
            decisions.take(name, False, why, fixed=fixed)


def _sphere_cull(scene: Scene, algorithm: str, decisions: Decisions) -> None:
    only = "only pairs whose bounding spheres touch go on"
    alone = f"without its cull, {algorithm} would be brute-force; choose that"
    if algorithm == "tree":
        decisions.take("sphere_cull", True, f"{only}, found by FCL's tree of boxes", fixed=alone)
        why = "FCL's tree takes any sizes as they are"
        decisions.take("size_classes", False, why, fixed="a tree has no cells; choose algorithm grid")
        return
    decisions.take("sphere_cull", True, f"{only}, found by a grid of cells", fixed=alone)
    sizes = scene.bodies.sizes
    if equal_sizes(scene):
        decisions.take("size_classes", False, "all bodies are of one size, so that one level of cells fits all")
        return
    why = f"sizes from {sizes.min():.3g} to {sizes.max():.3g} m: a level of cells for each factor of three"
    decisions.take("size_classes", True, why)


def _spheres(algorithm: str, decisions: Decisions) -> None:
    why, fixed = "a sphere is its own bounding sphere", "spheres have no hull and no surface of triangles"
    for name in ("hull_axis", "crossing"):
        decisions.take(name, False, why, fixed=fixed)
    if algorithm == "tree":
        decisions.take("fcl", True, "FCL puts spheres whose boxes overlap to the test", fixed=_JUDGE)
    else:
        why = "spheres that touch are hits as they are: no library is asked"
        decisions.take("fcl", False, why, fixed="the test of the cull is exact for spheres already")
    decisions.take("containment", False, "a sphere is solid: inside is touching", fixed=fixed)


def _solids(scene: Scene, algorithm: str, decisions: Decisions) -> None:
    mesh = scene.mesh
    assert mesh is not None, "hulls and meshes come from a mesh"
    if algorithm == "tree":
        hulls = decisions.take("hull_axis", False, "tree leaves close pairs to FCL")
    elif scene.shape == "hull":
        why = f"the hulls of {len(mesh.hull.vertices)} vertices are settled by separating axis and GJK"
        hulls = decisions.take("hull_axis", True, why)
    else:
        why = f"only pairs whose hulls ({len(mesh.hull.vertices)} vertices) overlap go on"
        hulls = decisions.take("hull_axis", True, f"{why}, by separating axis and GJK")
    crossing = _crossing(scene, hulls, decisions)
    left = "what rounding leaves open of the hulls" if scene.shape == "hull" else "what the hulls leave open"
    if not hulls:
        left = "all close pairs"
    elif crossing:
        left = "what the search for a crossing leaves open"
    decisions.take("fcl", True, f"FCL is the judge of {left}", fixed=_JUDGE)
    _containment(scene, hulls, decisions)


def _crossing(scene: Scene, hulls: bool, decisions: Decisions) -> bool:
    mesh = scene.mesh
    assert mesh is not None
    if scene.shape == "hull":
        fixed = "a hull that overlaps touches, whether its surface crosses another or not"
        return decisions.take("crossing", False, "the shape is the hull", fixed=fixed)
    if not hulls:
        fixed = "it starts from pairs whose hulls overlap; keep hull_axis"
        return decisions.take("crossing", False, "without the hulls' verdict FCL has all close pairs", fixed=fixed)
    if mesh.convex and equal_sizes(scene):
        why = "the mesh is convex, thus its own hull, and of one size: whether the hulls overlap decides"
        return decisions.take("crossing", False, why)
    if mesh.convex:
        why = "the mesh is convex, but of bodies of different sizes one may be inside the other, which is no hit"
    else:
        why = "the mesh is not convex: two triangles that cross prove a hit, a full traversal that there is none"
    return decisions.take("crossing", True, f"{why} ({len(mesh.faces)} faces)")


def _containment(scene: Scene, hulls: bool, decisions: Decisions) -> None:
    if scene.shape == "hull":
        fixed = "a hull inside another is a hit"
        decisions.take("containment", False, "a hull is solid: inside is touching", fixed=fixed)
    elif not hulls:
        fixed = "it is asked of pairs whose hulls overlap; keep hull_axis"
        decisions.take("containment", False, "without the hulls' verdict nobody looks for it", fixed=fixed)
    elif equal_sizes(scene):
        decisions.take("containment", False, "of bodies of one size none can be inside another")
    else:
        fixed = "contained pairs would go uncounted"
        why = "a mesh wholly inside a larger one is no hit, and counted apart"
        decisions.take("containment", True, why, fixed=fixed)


def equal_sizes(scene: Scene) -> bool:
    """Whether all bodies are of one size."""
    sizes = scene.bodies.sizes
    return bool((sizes == sizes[:1]).all())
