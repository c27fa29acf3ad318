"""Bodies of any shapes, in their sizes and orientations, as the event loop needs them.

Orientations are exact functions of absolute time, exp(w t) q0. Like positions they are counted from a base of time
that follows the present, and at every new base they are made anew from q0 with the angle in twice the digits: at 10^9 s
an angle of |w| t, rounded, would be off by 10^-7.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel, step
from harness.motion.predictive.double_double import DOUBLE_DOUBLE, angle_after, norm
from harness.motion.predictive.state import Record, Records, World
from harness.motion.predictive.windows import Windows
from harness.narrowphase.body_shapes import Shapes, shape_of, shapes_of_bodies
from harness.narrowphase.clearance_field import clearance_field, no_field
from harness.narrowphase.free_flight import Motion
from harness.narrowphase.mesh_advancement import MeshShape
from harness.narrowphase.support import support_map
from harness.narrowphase.triangle_tree import triangle_tree
from harness.narrowphase.units import unit_of
from harness.narrowphase.vectors import Vector
from harness.scene.bodies import Bodies
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene

Quaternion = tuple[float, float, float, float]


class Form:
    """What the narrow search needs of a shape, made once for all bodies.

    Parameters
    ----------
    scene : Scene of shape `hull` or `mesh`
    surface : whether the surface is to be searched where hulls touch; by default where the scene needs it
    followed : whether contacts of surfaces are to be followed to their end, fast
    """

    def __init__(self, scene: Scene, surface: bool | None = None, *, followed: bool = False) -> None:
        if scene.shape == "sphere":
            raise ValueError("a sphere has no surface to search")
        self.concave = needs_its_surface(scene) if surface is None else surface
        shapes = [_shape(mesh, surface=self.concave, followed=followed) for mesh in scene.meshes]
        self._shapes, self._mesh_of = shapes, scene.mesh_of

    def shapes(self, order: Ints) -> Shapes:
        """The surfaces of the bodies in an order, (n,) int array of which body comes where."""
        return shapes_of_bodies(self._shapes, self._mesh_of[order])


def _shape(mesh: Mesh, *, surface: bool, followed: bool) -> MeshShape:
    """A mesh of diameter 1, of which the surface is one triangle where it is not searched."""
    tree = triangle_tree(mesh.vertices, mesh.faces if surface else mesh.faces[:1])
    field = clearance_field(mesh) if surface and followed else no_field()
    return MeshShape(support_map(mesh.hull.vertices), tree, 0.5, field)


def needs_its_surface(scene: Scene) -> bool:
    """Whether bodies may touch otherwise than their hulls do.

    Convex meshes do not, unless one is wholly inside another, which equal bodies cannot be.
    """
    equal = len(set(scene.bodies.sizes.tolist())) < 2  # none at all, too
    convex = all(mesh.convex for mesh in scene.meshes) and equal
    return scene.shape == "mesh" and not convex


class Solids(NamedTuple):
    """n bodies.

    Attributes
    ----------
    shapes : of diameter 1; for bodies whose hull is all there is of them, a tree holds one triangle only
    concave : whether the surface is to be searched where hulls touch
    sizes : (n,) m, diameters of the bounding spheres
    reaches : (n,) m, farthest that any point is from its axis of spin through the centre
    spins : (n, 3) rad/s, in the world
    rates : (n,) of DOUBLE_DOUBLE, rad/s, |spin|
    start : (n, 4) orientations at time 0, w x y z
    turns : (n, 4) orientations at the base of time
    tolerance : of the mean size of two bodies: gaps below are contact
    scale : units a metre, a power of two, so that bodies are about 1 across in the narrow phase
    """

    shapes: Shapes
    concave: bool
    sizes: Floats
    reaches: Floats
    spins: Floats
    rates: Records
    start: Floats
    turns: Floats
    tolerance: float
    scale: float


class SolidWorld(NamedTuple):
    """The spheres around the bodies, the bodies, and their windows."""

    world: World
    body: Solids
    windows: Windows


def solids(form: Form, bodies: Bodies, order: Ints, tolerance: float) -> Solids:
    """Solids at time 0, in another order than the bodies.

    Parameters
    ----------
    form : Form
    bodies : Bodies
    order : (n,) int array, which body comes where
    tolerance : as in `Solids`
    """
    sizes, spins, start = bodies.sizes[order], bodies.spins[order], bodies.quaternions[order]
    reaches, rates = np.empty(len(sizes)), np.empty(len(sizes), dtype=DOUBLE_DOUBLE)
    shapes = form.shapes(order)
    measure(shapes, sizes, spins, start, reaches, rates)
    scale = 1.0 / unit_of(sizes)
    turns = start.copy()
    return Solids(
        shapes,
        form.concave,
        sizes=sizes,
        reaches=reaches,
        spins=spins,
        rates=rates,
        start=start,
        turns=turns,
        tolerance=tolerance,
        scale=scale,
    )


@kernel
def measure(shapes: Shapes, sizes: Floats, spins: Floats, start: Floats, reaches: Floats, rates: Records) -> None:
    """Fill in reaches and rates."""
    for k in range(len(sizes)):
        x, y, z = spins[k]
        high, low = norm(x, y, z)
        rates[k].high, rates[k].low = high, low
        reaches[k] = 0.5 * sizes[k]
        if high > 0.0:
            # the axis stands still in the body too
            w, a, b, c = start[k]
            x, y, z = x / high, y / high, z / high
            s, t, u = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
            x, y, z = x - w * s + b * u - c * t, y - w * t + c * s - a * u, z - w * u + a * t - b * s
            farthest, vertices = 0.0, shape_of(shapes, k).hull.vertices
            for vertex in range(len(vertices)):
                p, q, r = vertices[vertex]
                along = x * p + y * q + z * r
                farthest = max(farthest, p * p + q * q + r * r - along * along)
            reaches[k] = min(reaches[k], sizes[k] * sqrt(farthest) * (1.0 + 1e-12))


@step
def motion_of(body: Solids, motions: Records, k: int, now: float) -> Motion:
    """Body k in free flight from the present on, in units."""
    position, velocity = motions[k].position, motions[k].velocity
    flown = now - motions[k].time
    scale = body.scale
    return Motion(
        (
            scale * (position[0] + velocity[0] * flown),
            scale * (position[1] + velocity[1] * flown),
            scale * (position[2] + velocity[2] * flown),
        ),
        (scale * velocity[0], scale * velocity[1], scale * velocity[2]),
        turned_by(
            (body.spins[k, 0], body.spins[k, 1], body.spins[k, 2]),
            body.rates[k].high,
            body.rates[k].high * now,
            (body.turns[k, 0], body.turns[k, 1], body.turns[k, 2], body.turns[k, 3]),
        ),
        (body.spins[k, 0], body.spins[k, 1], body.spins[k, 2]),
        scale * body.sizes[k],
        scale * body.reaches[k],
    )


@step
def turn_to_base(body: Solids, clock: Record) -> None:
    """Orientations at a new base of time, from those at time 0."""
    for k in range(body.sizes.size):
        rate = body.rates[k]
        angle = angle_after(rate.high, rate.low, clock.epoch, clock.epoch_rest)
        spin = (body.spins[k, 0], body.spins[k, 1], body.spins[k, 2])
        start = (body.start[k, 0], body.start[k, 1], body.start[k, 2], body.start[k, 3])
        w, x, y, z = turned_by(spin, rate.high, angle, start)
        body.turns[k, 0], body.turns[k, 1], body.turns[k, 2], body.turns[k, 3] = w, x, y, z


@step
def turned_by(spin: Vector, rate: float, angle: float, q: Quaternion) -> Quaternion:
    """q, turned by an angle about the axis of the spin."""
    c = cos(0.5 * angle)
    s = sin(0.5 * angle) / rate if rate > 0.0 else 0.0
    x, y, z = s * spin[0], s * spin[1], s * spin[2]
    w0, x0, y0, z0 = q
    return (
        c * w0 - x * x0 - y * y0 - z * z0,
        c * x0 + x * w0 + y * z0 - z * y0,
        c * y0 - x * z0 + y * w0 + z * x0,
        c * z0 + x * y0 - y * x0 + z * w0,
    )
