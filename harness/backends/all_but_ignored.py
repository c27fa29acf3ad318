"""A loaded backend without the pairs that a scene ignores: a library is told of bodies, not of pairs."""

from __future__ import annotations

from collections.abc import Mapping

from harness.arrays import Floats, Pairs
from harness.backends.contract import require_pairs
from harness.backends.protocol import Backend
from harness.scene.ignored_pairs import without
from harness.scene.scene import Scene
from harness.vocabulary import Shape


class AllButIgnored:
    """A backend in the form of another.

    Parameters
    ----------
    backend : loaded
    ignored : (m, 2) int array, i < j, sorted
    """

    def __init__(self, backend: Backend, ignored: Pairs) -> None:
        self.name, self.shapes = backend.name, backend.shapes
        self._backend, self._ignored = backend, ignored

    @property
    def counters(self) -> Mapping[str, float]:
        """What the backend counts."""
        counted: Mapping[str, float] = getattr(self._backend, "counters", {})
        return counted

    def tolerance(self, shape: Shape) -> float:
        """As of the backend."""
        return self._backend.tolerance(shape)

    def load(self, scene: Scene) -> None:
        """Load the backend with another scene, of which the same pairs are ignored."""
        self._backend.load(scene)

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        """All touching pairs but the ignored."""
        answer = require_pairs(self.name, self._backend.pairs(positions, quaternions), len(positions))
        return without(answer, self._ignored)
