"""A body as a caller describes it: what it is made of, where it is, how it moves; at one pose or at many."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeAlias, cast, get_args

import numpy as np
from numpy.typing import ArrayLike

from harness.arrays import Floats
from harness.errors import InputError
from harness.experiment.mesh_location import locate_mesh
from harness.narrowphase.gap import MeshGapShape, mesh_gap_shape
from harness.scene.mesh import Mesh
from harness.scene.mesh_file import make_mesh, read_mesh
from harness.vocabulary import Shape

MeshSource: TypeAlias = Any
"""A path, `package:NAME/PATH`, a `trimesh.Trimesh`, a `Mesh`, or None."""

# Meshes of files, and shapes made ready for searches, that are kept.
_KEPT = 32


class Body:
    """A rigid body with a mesh, at one pose or at many.

    Parameters
    ----------
    mesh : path of a mesh file, also `package:NAME/PATH` or a file in `meshes/`; or a `trimesh.Trimesh`; None only for a
        sphere. Its bounding sphere becomes 1 in diameter, and the body's centre is the centre of that sphere.
    position : (3,) or (n, 3) m, of the centre
    quaternion : (4,) or (n, 4), w x y z, from the mesh's axes to the world's; of any length but 0
    size : m, diameter of the bounding sphere
    velocity : (3,) or (n, 3) m/s
    spin : (3,) or (n, 3) rad/s, in the world's axes
    shape : "mesh" for the surface itself, "hull" for its convex hull, "sphere" for its bounding sphere

    Raises
    ------
    harness.errors.InputError
        If there is no such mesh, or an array is of the wrong shape or not finite, or a size not above 0.

    Examples
    --------
    >>> Body("cube.ply", position=(2, 0, 0), shape="hull")
    Body(cube.ply, hull, size 1.0)
    >>> len(Body("cube.ply", position=[(2, 0, 0), (3, 0, 0)]))
    2
    """

    def __init__(
        self,
        mesh: MeshSource,
        position: ArrayLike = (0.0, 0.0, 0.0),
        quaternion: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        size: float = 1.0,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        spin: ArrayLike = (0.0, 0.0, 0.0),
        shape: Shape = "mesh",
    ) -> None:
        if shape not in get_args(Shape):
            raise InputError(f"shape is {shape!r}; it must be one of {', '.join(get_args(Shape))}")
        if mesh is None and shape != "sphere":
            raise InputError(f"a body of shape {shape} needs a mesh; only a sphere does without")
        self.shape: Shape = shape
        self.mesh = None if mesh is None else _mesh_of(mesh)
        self.size = _size(size)
        self.position = _vectors("position", position, 3)
        self.quaternion = _unit_quaternions(_vectors("quaternion", quaternion, 4))
        self.velocity = _vectors("velocity", velocity, 3)
        self.spin = _vectors("spin", spin, 3)
        lengths = {len(part) for part in (self.position, self.quaternion, self.velocity, self.spin) if part.ndim == 2}
        if len(lengths) > 1:
            raise InputError(
                f"a body has arrays of {' and '.join(map(str, sorted(lengths)))} rows; they must be as many"
            )
        self.count: int | None = lengths.pop() if lengths else None

    def __len__(self) -> int:
        """How many poses the body has."""
        return 1 if self.count is None else self.count

    def __repr__(self) -> str:
        return f"Body({self.mesh.name if self.mesh else None}, {self.shape}, size {self.size})"


def pose_count(a: Body, b: Body) -> int | None:
    """How many poses two bodies have together; None if each has one that is no array.

    Raises
    ------
    harness.errors.InputError
        If they are no bodies of one shape and as many poses.
    """
    for name, body in (("first", a), ("second", b)):
        if not isinstance(body, Body):
            raise InputError(f"the {name} body is a {type(body).__name__}; it must be a harness.Body")
    if a.shape != b.shape:
        raise InputError(f"one body's shape is {a.shape}, the other's {b.shape}; they must be the same")
    if a.count is not None and b.count is not None and a.count != b.count:
        raise InputError(
            f"one body has {a.count} poses, the other {b.count}; they must have as many, or one of them one"
        )
    return b.count if a.count is None else a.count


def rows(array: Floats, count: int | None) -> Floats:
    """(count, k): the rows of an array, or its only one again and again.

    A copy, so that it may be written to: kernels would be compiled once more for arrays that may not.
    """
    shape = (count or (1 if count is None else 0), array.shape[-1])
    return np.array(np.broadcast_to(array, shape), order="C")


def searchable(body: Body) -> MeshGapShape:
    """The mesh of a body made ready for searches; kept, as it takes longer than most answers."""
    return _searchable(_ByContent(cast(Mesh, body.mesh)))


class _ByContent:
    """A mesh that is equal to any other of the same arrays."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh

    def __hash__(self) -> int:
        return hash(self.mesh.digest)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ByContent) and other.mesh.digest == self.mesh.digest


@lru_cache(_KEPT)
def _searchable(key: _ByContent) -> MeshGapShape:
    return mesh_gap_shape(key.mesh)


def _mesh_of(source: MeshSource) -> Mesh:
    if isinstance(source, Mesh):
        return source
    if isinstance(source, str | os.PathLike):
        path = _located(os.fspath(source))
        about = path.stat()
        return _read(path, about.st_mtime_ns, about.st_size)
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        return make_mesh("mesh", np.asarray(source.vertices, np.float64), np.asarray(source.faces))
    raise InputError(f"a mesh is a path or a trimesh.Trimesh, not a {type(source).__name__}")


def _located(source: str) -> Path:
    path = Path(source)
    if path.is_file():
        return path.resolve()
    try:
        return locate_mesh(source, Path())
    except InputError as error:
        raise InputError(str(error).replace("beside the experiment", "here")) from None


@lru_cache(_KEPT)
def _read(path: Path, changed: int, size: int) -> Mesh:
    """The mesh of a file as it is at this time."""
    return read_mesh(path)


def _vectors(name: str, given: ArrayLike, width: int) -> Floats:
    """(width,) or (n, width), finite, of its own."""
    try:
        array = np.array(given, np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} is no array of numbers") from None
    if array.ndim not in (1, 2) or array.shape[-1] != width:
        raise InputError(f"{name} has the shape {array.shape}; it must be ({width},), or (n, {width}) for n poses")
    wrong = ~np.isfinite(array).all(axis=-1)
    if wrong.any():
        where = "" if array.ndim == 1 else f", first in row {int(np.argmax(wrong))}"
        raise InputError(f"{name} is not finite{where}")
    array.setflags(write=False)
    return array


def _unit_quaternions(array: Floats) -> Floats:
    largest = np.abs(array).max(axis=-1, keepdims=True, initial=0.0)
    if not largest.all():
        where = "" if array.ndim == 1 else f", first in row {int(np.argmin(largest[:, 0]))}"
        raise InputError(f"quaternion is zero, which turns into no direction{where}")
    scaled = array / largest  # so that no square is too small or too large for a float
    return np.asarray(scaled / np.linalg.norm(scaled, axis=-1, keepdims=True), np.float64)


def _size(given: float) -> float:
    try:
        size = float(given)
    except (TypeError, ValueError):
        raise InputError(f"size is {given!r}; it must be a number, of m") from None
    if not 0.0 < size < np.inf:
        raise InputError(f"size is {size:g}; it must be above 0 and finite")
    return size
