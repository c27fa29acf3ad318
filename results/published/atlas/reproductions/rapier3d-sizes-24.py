"""rapier3d: separate hulls of which it says the opposite (at rest). Needs numpy and rapier3d alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import rapier3d

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()


# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 64 m
A = np.array([[0.7812402336593889, 0.0, -0.0039062011682969443], [0.5524202675918185, 0.5524202675918185, -0.0039062011682969443], [0.0, 0.7812402336593889, -0.0039062011682969443], [-0.5524202675918185, 0.5524202675918185, -0.0039062011682969443], [-0.7812402336593889, 0.0, -0.0039062011682969443], [-0.5524202675918185, -0.5524202675918185, -0.0039062011682969443], [0.0, -0.7812402336593889, -0.0039062011682969443], [0.5524202675918185, -0.5524202675918185, -0.0039062011682969443], [0.7812402336593889, 0.0, 0.0039062011682969443], [0.5524202675918185, 0.5524202675918185, 0.0039062011682969443], [0.0, 0.7812402336593889, 0.0039062011682969443], [-0.5524202675918185, 0.5524202675918185, 0.0039062011682969443], [-0.7812402336593889, 0.0, 0.0039062011682969443], [-0.5524202675918185, -0.5524202675918185, 0.0039062011682969443], [0.0, -0.7812402336593889, 0.0039062011682969443], [0.5524202675918185, -0.5524202675918185, 0.0039062011682969443]], "<f8")
FACES_A = unpacked("c-l>miw=Mw2t_H>lnDR-Z`19xV7uGl%0og#>QY;J;8;?)z=!;C;VHa(PimCB!Uc9z+2iT`hMoC)&OjY+vg?bE*YGEbbjxN#j@OxM?DbSLc@NmQOH+-~XZ-Vo2l)$mp8|6", "<i4")
B = np.array([[0.007812402336593889, 0.0, -3.9062011682969445e-05], [0.005524202675918185, 0.005524202675918185, -3.9062011682969445e-05], [0.0, 0.007812402336593889, -3.9062011682969445e-05], [-0.005524202675918185, 0.005524202675918185, -3.9062011682969445e-05], [-0.007812402336593889, 0.0, -3.9062011682969445e-05], [-0.005524202675918185, -0.005524202675918185, -3.9062011682969445e-05], [0.0, -0.007812402336593889, -3.9062011682969445e-05], [0.005524202675918185, -0.005524202675918185, -3.9062011682969445e-05], [0.007812402336593889, 0.0, 3.9062011682969445e-05], [0.005524202675918185, 0.005524202675918185, 3.9062011682969445e-05], [0.0, 0.007812402336593889, 3.9062011682969445e-05], [-0.005524202675918185, 0.005524202675918185, 3.9062011682969445e-05], [-0.007812402336593889, 0.0, 3.9062011682969445e-05], [-0.005524202675918185, -0.005524202675918185, 3.9062011682969445e-05], [0.0, -0.007812402336593889, 3.9062011682969445e-05], [0.005524202675918185, -0.005524202675918185, 3.9062011682969445e-05]], "<f8")
FACES_B = unpacked("c-l>miw=Mw2t_H>lnDR-Z`19xV7uGl%0og#>QY;J;8;?)z=!;C;VHa(PimCB!Uc9z+2iT`hMoC)&OjY+vg?bE*YGEbbjxN#j@OxM?DbSLc@NmQOH+-~XZ-Vo2l)$mp8|6", "<i4")
P, Q = [0.0, 0.0, 0.0], [0.14759961845547945, -0.7505980597065235, 0.5367986123773806, 0.35589908000206727]
R, S = [-0.71453125, -0.305, 0.1296875], [-0.29749198269909793, -0.16609552378595013, 0.9199752070022524, 0.19379477730112665]


def touching():
    colliders, narrow = rapier3d.ColliderSet(), rapier3d.NarrowPhase()
    middle = (np.array(P) + R) / 2  # single precision has few digits to lose
    for vertices, place, quaternion in ((A, P, Q), (B, R, S)):
        shape = rapier3d.SharedShape.convex_hull(vertices.tolist())
        kinds = rapier3d.ActiveCollisionTypes.all()
        collider = rapier3d.Collider.new(shape).sensor(True).active_collision_types(kinds)
        place = rapier3d.Vec3(*(place - middle))
        colliders[colliders.insert(collider)].position = rapier3d.Isometry3(place, rapier3d.Rotation3(*quaternion))
    rapier3d.CollisionPipeline().step(
        0.0, rapier3d.IslandManager(), rapier3d.BroadPhaseBvh(), narrow, rapier3d.RigidBodySet(), colliders)
    return any(touching for _, _, touching in narrow.intersection_pairs())


def exact(points, position, quaternion):
    """The points in the world, as fractions."""
    w, x, y, z = map(Fraction, quaternion)
    n = w * w + x * x + y * y + z * z
    rows = [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]]
    return [[Fraction(t) + sum(r * Fraction(c) for r, c in zip(row, point)) / n for row, t in zip(rows, position)]
            for point in points.tolist()]


one, other = exact(A, P, Q), exact(B, R, S)
# along this direction every point of the first lies farther than every point of the second
normal = [Fraction(part) for part in [0.7633577238917569, 0.6400866006696135, -0.08702947212303909]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 7.79e-05 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version is right")
