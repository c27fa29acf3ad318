"""Compile what a run calls, or load it from numba's cache, before any clock runs: only what its pipeline needs."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from harness.experiment.experiment import Point
from harness.kernel import compiles
from harness.methods.method import WarmUp
from harness.methods.warm_up_scene import two_bodies
from harness.reference.warm_up import warm_up_reference
from harness.runner import accuracy
from harness.runner.point import method_of_point
from harness.runner.scene_of_point import mesh_count
from harness.scene.box import Box
from harness.scene.launch import place
from harness.vocabulary import Shape

_compiled: set[str] = set()


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
    left = {name: compile_it for name, compile_it in warm_ups(point) if name not in _compiled}
    for name, compile_it in left.items():
        compile_it()
        _compiled.add(name)
    return bool(left)


def warm_ups(point: Point) -> Iterator[WarmUp]:
    """What has to be compiled before a run of a point."""
    yield "placement", _compile_placement
    yield from method_of_point(point).warm_ups(mesh_count(point))
    if point.reference is not None:
        shape = point.reference.shape
        # its kernels take the meshes of two bodies, and are the same however many there are
        yield f"reference of {shape}s", partial(_compile_reference, shape)
        if point.motion.response != "none":  # the reference has to be flown
            yield from method_of_point(accuracy.reference_point(point)).warm_ups(mesh_count(point))


def _compile_placement() -> None:
    if not compiles():  # and Python cannot place dense scenes
        return
    dense = Box(np.array([0.55, 0.55, 1.2]))  # a loose scene takes no kernel
    place(np.full(2, 0.5), dense, np.random.default_rng(0), overlap=False)


def _compile_reference(shape: Shape) -> None:
    warm_up_reference(two_bodies(shape))
