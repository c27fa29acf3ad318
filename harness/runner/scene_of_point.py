"""From a point of an experiment to the scene it declares: everything random is drawn here, from the point's seed."""

from __future__ import annotations

import numpy as np

from harness.experiment.experiment import Point
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.launch import directions, orientations, place
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene

# The most sizes drawn to compute the packing of a scene; of more bodies, a sample is drawn.
MOST_DRAWN = 10**6
# Bytes that a body needs at the least, for poses, velocities and neighbours: enough to refuse what cannot fit.
BYTES_A_BODY = 500


class SceneSizeError(Exception):
    """The scene would need more memory than the run may use."""


def build_scene(point: Point, mesh: Mesh | None, memory: int | None = None) -> Scene:
    """The scene of a point.

    Parameters
    ----------
    point : Point
    mesh : the mesh its scene names; None for spheres without one
    memory : B the run may use; more is refused before anything is allocated

    Raises
    ------
    SceneSizeError
    PlacementError
        If the bodies do not fit into the box.

    Notes
    -----
    Sizes, places, orientations, directions, speeds and spins are drawn from streams of their own, so that changing the
    distribution of one leaves the others as they were.
    """
    count = point.scene.count if point.scene.bodies is None else len(point.scene.bodies)
    _refuse_too_large(count or 0, memory)
    bodies = _launched(point) if point.scene.bodies is None else _explicit(point)
    return Scene(point.scene.shape, mesh, bodies, box_of(point))


def box_of(point: Point) -> Box:
    """The box of a point: as given, or a cube by its ratio (mean size / side)² to the bodies."""
    if point.scene.box is not None:
        return Box(np.array(point.scene.box) / 2)
    assert point.scene.box_ratio is not None, "the schema asks for a box or a box_ratio"
    side = _mean_size(point) / np.sqrt(point.scene.box_ratio)
    return Box(np.full(3, side / 2))


def derived_parameters(point: Point, mesh: Mesh | None) -> dict[str, float]:
    """`faces`, `hull_vertices`, `packing` and `box_side` of a point, without placing its bodies.

    Packing is that of the sizes really drawn, of a million bodies and more that of the first million.
    """
    box = box_of(point)
    if point.scene.bodies is not None:
        cubes = sum(body.size**3 for body in point.scene.bodies)
    elif point.scene.size.kind == "constant":
        cubes = (point.scene.count or 0) * point.scene.size.mean**3
    else:
        count = point.scene.count or 0
        drawn = point.scene.size.sample(_streams(point)["sizes"], min(count, MOST_DRAWN))
        cubes = float((drawn**3).sum()) * (count / max(1, len(drawn)))
    return {
        "faces": len(mesh.faces) if mesh else 0,
        "hull_vertices": len(mesh.hull.vertices) if mesh else 0,
        "packing": float(np.pi / 6 * cubes / box.volume),
        "box_side": float(np.cbrt(box.volume)),
    }


def _mean_size(point: Point) -> float:
    if point.scene.bodies is None:
        return float(point.scene.size.mean)
    return float(np.mean([body.size for body in point.scene.bodies])) if point.scene.bodies else 1.0


def _streams(point: Point) -> dict[str, np.random.Generator]:
    names = ("sizes", "places", "orientations", "directions", "speeds", "axes", "spins")
    seeds = np.random.SeedSequence(point.scene.seed).spawn(len(names))
    return {name: np.random.default_rng(seed) for name, seed in zip(names, seeds, strict=True)}


def _sizes(point: Point) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return point.scene.size.sample(_streams(point)["sizes"], point.scene.count or 0)


def _launched(point: Point) -> Bodies:
    scene, count, rng = point.scene, point.scene.count or 0, _streams(point)
    sizes = _sizes(point)
    speeds, spins = scene.speed.sample(rng["speeds"], count), scene.spin.sample(rng["spins"], count)
    return Bodies(
        positions=place(sizes / 2, box_of(point), rng["places"], overlap=scene.overlap == "allow"),
        velocities=directions(rng["directions"], count) * speeds[:, None],
        quaternions=orientations(rng["orientations"], count),
        spins=directions(rng["axes"], count) * spins[:, None],
        sizes=sizes,
        masses=sizes**3,
    )


def _explicit(point: Point) -> Bodies:
    bodies = point.scene.bodies or ()
    quaternions = np.array([body.orientation for body in bodies], np.float64).reshape(-1, 4)
    return Bodies(
        positions=np.array([body.position for body in bodies], np.float64).reshape(-1, 3),
        velocities=np.array([body.velocity for body in bodies], np.float64).reshape(-1, 3),
        quaternions=quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True),
        spins=np.array([body.spin for body in bodies], np.float64).reshape(-1, 3),
        sizes=np.array([body.size for body in bodies], np.float64),
        masses=np.array([body.size**3 if body.mass is None else body.mass for body in bodies], np.float64),
    )


def _refuse_too_large(count: int, memory: int | None) -> None:
    if memory is not None and count * BYTES_A_BODY > memory:
        needed, allowed = count * BYTES_A_BODY / 2**30, memory / 2**30
        raise SceneSizeError(
            f"{count} bodies need at least {needed:.3g} GiB, and measure.memory allows {allowed:.3g} GiB"
        )
