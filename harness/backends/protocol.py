"""What a backend is: a complete detector, asked for all touching pairs at given poses.

A file of this folder adds one by a class of this form and a line `BACKEND = Class`; another package by an entry point
in the group `harness.backends`. It is then named by `engine.backend`, with its own pipeline as the algorithm. What the
functions below ask for, a backend may have beside that.

One that says `queries` answers more than whether bodies touch: with "distance" it has the method of `Distances`, with
"tolerance" that or the one of `Near`, with "impact" that of `Impacts`. Where it tells gaps of some of its shapes alone,
`gap_shapes` are those. `shapes`, `queries` and `gap_shapes` are written out in the class, so that an experiment that
asks for anything else is refused before a library is imported.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

from harness.vocabulary import Query, Shape

if TYPE_CHECKING:  # of numpy, which a list of the backends can do without
    from harness.arrays import Floats, Pairs
    from harness.scene.hull import Hull
    from harness.scene.scene import Scene, Solid


DEFAULT_QUERIES: tuple[Query, ...] = ("collision",)
"""What a backend answers that does not say it."""


class NearPairs(NamedTuple):
    """Which pairs are near, and how far apart.

    Attributes
    ----------
    pairs : (k, 2) int array, i < j, sorted
    gaps : (k,) float array, m, each at most the distance that was asked for; 0 where the two touch
    points : (k, 2, 3) float array, m, in the world: the nearest point of i and that of j; those of touching pairs may
        be nan. None from a library that has no points
    """

    pairs: Pairs
    gaps: Floats
    points: Floats | None


class ImpactTimes(NamedTuple):
    """Which pairs begin to touch, and when.

    Attributes
    ----------
    pairs : (k, 2) int array, i < j, sorted
    times : (k,) float array, s after the start of the frame
    """

    pairs: Pairs
    times: Floats


@runtime_checkable
class Backend(Protocol):
    """A detector; made without arguments, then loaded once, then asked once a frame.

    It does not move anything: motion, box walls and response are the same for all backends. What it does for an answer
    it does before it returns, and in this process: clocks see nothing else, unless a child's time is charged to it
    (`harness.cpu_time.charge`).

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


class Distances(Backend, Protocol):
    """A backend whose `queries` have "distance", or "tolerance", which takes the pairs of the same answer."""

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        """All pairs whose gap is at most a distance.

        Parameters
        ----------
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, unit, w x y z
        within : m
        """


@runtime_checkable
class Near(Backend, Protocol):
    """A backend whose `queries` have "tolerance", and whose library decides it for less than it measures a gap."""

    def near(self, positions: Floats, quaternions: Floats, within: float) -> Pairs:
        """The pairs whose gap is at most `within`, m, sorted; parameters as for `Distances.distances`."""


class Impacts(Backend, Protocol):
    """A backend whose `queries` have "impact"."""

    def impacts(
        self, positions: Floats, quaternions: Floats, velocities: Floats, spins: Floats, duration: float
    ) -> ImpactTimes:
        """All pairs that begin to touch in a frame: those that are apart at its start and touch later, up to its end.

        Every body moves at constant velocity and constant spin.

        Parameters
        ----------
        positions : (n, 3) float array, m, at the start
        quaternions : (n, 4) float array, unit, w x y z, at the start
        velocities : (n, 3) float array, m/s
        spins : (n, 3) float array, rad/s, in the world's axes
        duration : s, of the frame
        """


def queries(backend: Backend) -> tuple[Query, ...]:
    """What the backend can be asked; one that does not say answers whether bodies touch."""
    said: tuple[Query, ...] = getattr(backend, "queries", DEFAULT_QUERIES)
    return said


def set_accuracy(backend: Backend, accuracy: float) -> bool:
    """Hand a backend that is not loaded yet the accuracy that is wanted; False if its library has no such knob.

    A backend that has one says so by an attribute `accuracy`.

    Parameters
    ----------
    accuracy : of gaps, or of the gap at a time of impact, as a fraction of the size of a body
    """
    if not hasattr(backend, "accuracy"):
        return False
    backend.accuracy = accuracy
    return True


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


def own_hulls(backend: Backend) -> Mapping[Solid, Hull]:
    """The hulls that a loaded backend holds in place of the scene's, in m, by what bodies share; else empty.

    A backend has them as `own_hulls`, by the number of the mesh and the size (m), or by the size alone if all bodies
    have one mesh.

    A comparison gives them to the other backend too, so that both are asked about the same solids.
    """
    from harness.scene.scene import by_solid

    return by_solid(getattr(backend, "own_hulls", {}))


def own_hulls_tolerance(backend: Backend) -> float:
    """The tolerance for hulls when the backend's own are what it is held against; 0 where it has none."""
    return float(getattr(backend, "own_hulls_tolerance", 0.0))
