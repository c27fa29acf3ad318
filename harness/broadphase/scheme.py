"""A broad-phase scheme as a method plans and makes it.

A new scheme is a file in this folder, named as the algorithm is, with a `SCHEME`; its word is a line in
`harness.vocabulary`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

from harness.arrays import Floats
from harness.broadphase.pairs import BroadPhase
from harness.scene.box import Box


@dataclass(frozen=True)
class Scheme:
    """A way to find the pairs whose bounding spheres touch.

    Parameters
    ----------
    found_by : completes a sentence of a plan: "only pairs whose bounding spheres touch go on, found by …"
    make : of radii (n,) in m, the box, and whether size classes are kept apart, a new `BroadPhase`
    size_classes : completes "sizes from 0.1 to 1 m: …", what is done for bodies of different sizes; without, they are
        all treated alike
    """

    found_by: str
    make: Callable[[Floats, Box, bool], BroadPhase]
    size_classes: str = ""


def scheme_of(algorithm: str) -> Scheme:
    """The scheme that an algorithm is named after.

    Raises
    ------
    ModuleNotFoundError
        If there is none.
    """
    scheme: Scheme = import_module(f"harness.broadphase.{algorithm.replace('-', '_')}").SCHEME
    return scheme
