"""Compile what a run calls, or load it from numba's cache, before any clock runs: only what its pipeline needs.

Every piece is flown once a process, with two tetrahedra that meet. A new pipeline is a row of `_PIECES`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Pairs
from harness.broadphase.grid import Grid
from harness.experiment.experiment import Point
from harness.motion.plan import make_plan
from harness.motion.predicted import fly_predicted
from harness.motion.stepped import fly_stepped
from harness.narrowphase.containment import Containment
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.hull_pairs import HullPairs
from harness.narrowphase.mesh_pairs import MeshPairs
from harness.narrowphase.penetration import Penetration
from harness.narrowphase.placement import Places
from harness.reference.warm_up import warm_up_reference
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import hull_of
from harness.scene.launch import place
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.vocabulary import Response, Shape

_RESPONSES: tuple[Response, ...] = ("reflect", "elastic", "none")


def warm_up(point: Point) -> bool:
    """Compile or load every kernel that a run of this point calls, and import what it may.

    Parameters
    ----------
    point : Point

    Returns
    -------
    bool
        Whether there was anything left to do.
    """
    wanted = list(pieces(point.engine.algorithm, point.scene.shape, forced=bool(point.engine.stages)))
    if point.reference is not None:
        wanted.append(_REFERENCES[point.reference.shape])
        if point.motion.response != "none":  # the reference has to be flown
            wanted += pieces("predictive", point.reference.shape)
    left = [fly for fly in dict.fromkeys(wanted) if fly not in _flown]
    for fly in left:
        fly()
        _flown.add(fly)
    return bool(left)


def pieces(algorithm: str, shape: Shape, *, forced: bool = False) -> Iterator[Callable[[], None]]:
    """What has to be flown once before a run.

    Parameters
    ----------
    algorithm, shape : of the run
    forced : whether it forces stages, which may be those of another algorithm
    """
    for piece in _PIECES:
        if shape in piece.shapes and (forced or algorithm in piece.algorithms):
            yield piece.fly


_flown: set[Callable[[], None]] = set()


def _placement() -> None:
    place(np.full(2, 0.5), Box(np.full(3, 1.2)), np.random.default_rng(0), overlap=False)


def _stepped_spheres() -> None:
    _step("sphere")


def _stepped_hulls() -> None:
    _step("hull")


def _cells() -> None:
    scene = _two("sphere")
    grid = Grid(scene.bodies.radii, scene.box)
    grid.close_pairs(scene.bodies.positions)
    grid.cells_per_body()


def _hull_pairs() -> None:
    mesh, bodies = _tetrahedron(), _two("hull").bodies
    HullPairs(mesh.hull, MARGIN).settle(_PAIR, Places(bodies.sizes).at(bodies.positions, bodies.quaternions))


def _mesh_pairs() -> None:
    mesh, bodies = _tetrahedron(), _two("mesh").bodies
    placement = Places(bodies.sizes).at(bodies.positions, bodies.quaternions)
    MeshPairs(mesh).settle(_PAIR, placement)
    Containment(mesh).contained(_PAIR, placement)


def _spheres_predicted() -> None:
    _predict("sphere")


def _hulls_predicted() -> None:
    _predict("hull")


def _meshes_predicted() -> None:
    _predict("mesh")


def _sphere_reference() -> None:
    warm_up_reference(_two("sphere"))


def _hull_reference() -> None:
    warm_up_reference(_two("hull"))


def _mesh_reference() -> None:
    warm_up_reference(_two("mesh"))


class _Piece(NamedTuple):
    """Kernels that belong together, and the runs that call them."""

    fly: Callable[[], None]
    algorithms: Collection[str]
    shapes: Collection[Shape]


_STEPPED = ("brute-force", "grid", "tree", "native")
_ALL: tuple[Shape, ...] = ("sphere", "hull", "mesh")
_SPHERES: tuple[Shape, ...] = ("sphere",)
_HULLS: tuple[Shape, ...] = ("hull",)
_TURNED: tuple[Shape, ...] = ("hull", "mesh")
_MESHES: tuple[Shape, ...] = ("mesh",)
_PIECES = (
    _Piece(_placement, (*_STEPPED, "predictive"), _ALL),
    _Piece(_stepped_spheres, _STEPPED, _SPHERES),
    _Piece(_stepped_hulls, _STEPPED, _TURNED),
    _Piece(_cells, ("grid", "predictive"), _ALL),
    _Piece(_hull_pairs, ("grid",), _TURNED),
    _Piece(_mesh_pairs, ("grid",), _MESHES),
    _Piece(_spheres_predicted, ("predictive",), _SPHERES),
    _Piece(_hulls_predicted, ("predictive",), _HULLS),
    _Piece(_meshes_predicted, ("predictive",), _MESHES),
)

_REFERENCES: dict[Shape, Callable[[], None]] = {
    "sphere": _sphere_reference, "hull": _hull_reference, "mesh": _mesh_reference,
}  # fmt: skip

_PAIR: Pairs = np.array([[0, 1]])


@cache
def _tetrahedron() -> Mesh:
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(12)
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], np.int32)
    hull = hull_of(corners, faces)
    return Mesh("tetrahedron", hull.vertices, hull.faces, hull, "", watertight=True, convex=True)


def _two(shape: Shape) -> Scene:
    """Two bodies that spin and are about to meet."""
    bodies = Bodies(
        positions=np.array([[-0.6, 0, 0], [0.6, 0, 0]]),
        velocities=np.array([[1.0, 1, 1], [-1, -1, -1]]),
        quaternions=np.tile([1.0, 0, 0, 0], (2, 1)),
        spins=np.ones((2, 3)),
        sizes=np.ones(2),
        masses=np.ones(2),
    )
    return Scene(shape, _tetrahedron(), bodies, Box(np.full(3, 1.2)))


def _step(shape: Shape) -> None:
    """Two frames with every response."""
    scene = _two(shape)
    for response in _RESPONSES:
        plan = make_plan(scene, backend="", algorithm="native", response=response)
        fly_stepped(scene, plan, _Meeting(), frames=2, dt=0.3, response=response)


def _predict(shape: Shape) -> None:
    """A flight from event to event with every response."""
    scene = _two(shape)
    for response in _RESPONSES:
        plan = make_plan(scene, backend="", algorithm="predictive", response=response)
        fly_predicted(scene, plan, duration=0.3, response=response)
    if shape != "mesh":
        Penetration(scene).deepest(_PAIR, scene.bodies.positions, scene.bodies.quaternions)


class _Meeting:
    """A detector to fly with: the two bodies always touch."""

    name = "meeting"
    shapes: tuple[Shape, ...] = ("sphere", "hull")

    def tolerance(self, shape: Shape) -> float:
        return 0.0

    def load(self, scene: Scene) -> None:
        pass

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return _PAIR
