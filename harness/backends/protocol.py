"""What a backend is: a complete detector, asked for all touching pairs at given poses.

A file of this folder adds one by a class of this form and a line `BACKEND = Class`; another package by an entry point
in the group `harness.backends`. It is then named by `engine.backend`, with its own pipeline as the algorithm. What the
functions below ask for, a backend may have beside that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

from harness.arrays import Floats, Pairs
from harness.scene.hull import Hull
from harness.scene.scene import Scene
from harness.vocabulary import Shape


@runtime_checkable
class Backend(Protocol):
    """A detector; made without arguments, then loaded once, then asked once a frame.

    It does not move anything: motion, box walls and response are the same for all backends.

    Attributes
    ----------
    name : as in `engine.backend`
    shapes : the shapes it can hold; a shape it only approximates is in `approximations` too
    """

    name: str
    shapes: tuple[Shape, ...]

    def tolerance(self, shape: Shape) -> float:
        """Gap, as a fraction of the size of a body, below which a verdict is not to be trusted."""

    def load(self, scene: Scene) -> None:
        """Build whatever the bodies of the scene need; no clock of a phase runs."""

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        """All touching pairs at these poses.

        Parameters
        ----------
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, unit, w x y z
        """


def units(backend: Backend) -> str:
    """In what lengths the backend tells its library of the scene; empty if it does not say."""
    return str(getattr(backend, "units", ""))


def precision(backend: Backend) -> str:
    """Of its numbers, such as "double"; empty if it does not say."""
    return str(getattr(backend, "precision", ""))


def approximations(backend: Backend) -> Mapping[Shape, str]:
    """The shapes that the backend replaces by another, and how; empty for an exact backend."""
    replaced: Mapping[Shape, str] = getattr(backend, "approximations", {})
    return replaced


def contained_is_touching(backend: Backend, shape: Shape) -> bool:
    """Whether the backend says that for a shape that is a surface it takes one body inside another for a touching pair.

    It says so by `solid`, the shapes of which it does; one that replaces a mesh by its hull need not say it again.
    """
    return shape in getattr(backend, "solid", ()) or shape in approximations(backend)


def own_hulls(backend: Backend) -> Mapping[float, Hull]:
    """The hulls that a loaded backend holds in place of the scene's, by the size of a body, both m; else empty.

    A comparison gives them to the other backend too, so that both are asked about the same solids.
    """
    held: Mapping[float, Hull] = getattr(backend, "own_hulls", {})
    return held


def own_hulls_tolerance(backend: Backend) -> float:
    """The tolerance for hulls when the backend's own are what it is held against; 0 where it has none."""
    return float(getattr(backend, "own_hulls_tolerance", 0.0))
