"""rapier3d: separate hulls of which it says the opposite (at rest). Needs numpy and rapier3d alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import rapier3d

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 0.5 m
A = np.array([[0.9999874990840177, 0.0, -0.004999937495420089], [0.7070979425175277, 0.7070979425175277, -0.004999937495420089], [0.0, 0.9999874990840177, -0.004999937495420089], [-0.7070979425175277, 0.7070979425175277, -0.004999937495420089], [-0.9999874990840177, 0.0, -0.004999937495420089], [-0.7070979425175277, -0.7070979425175277, -0.004999937495420089], [0.0, -0.9999874990840177, -0.004999937495420089], [0.7070979425175277, -0.7070979425175277, -0.004999937495420089], [0.9999874990840177, 0.0, 0.004999937495420089], [0.7070979425175277, 0.7070979425175277, 0.004999937495420089], [0.0, 0.9999874990840177, 0.004999937495420089], [-0.7070979425175277, 0.7070979425175277, 0.004999937495420089], [-0.9999874990840177, 0.0, 0.004999937495420089], [-0.7070979425175277, -0.7070979425175277, 0.004999937495420089], [0.0, -0.9999874990840177, 0.004999937495420089], [0.7070979425175277, -0.7070979425175277, 0.004999937495420089]], "<f8")
FACES_A = unpacked("c-l>miw=Mw2t_H>lnDR-Z`19xV7uGl%0og#>QY;J;8;?)z=!;C;VHa(PimCB!Uc9z+2iT`hMoC)&OjY+vg?bE*YGEbbjxN#j@OxM?DbSLc@NmQOH+-~XZ-Vo2l)$mp8|6", "<i4")
B = np.array([[0.04999937495420089, 0.0, -0.00024999687477100444], [0.03535489712587638, 0.03535489712587638, -0.00024999687477100444], [0.0, 0.04999937495420089, -0.00024999687477100444], [-0.03535489712587638, 0.03535489712587638, -0.00024999687477100444], [-0.04999937495420089, 0.0, -0.00024999687477100444], [-0.03535489712587638, -0.03535489712587638, -0.00024999687477100444], [0.0, -0.04999937495420089, -0.00024999687477100444], [0.03535489712587638, -0.03535489712587638, -0.00024999687477100444], [0.04999937495420089, 0.0, 0.00024999687477100444], [0.03535489712587638, 0.03535489712587638, 0.00024999687477100444], [0.0, 0.04999937495420089, 0.00024999687477100444], [-0.03535489712587638, 0.03535489712587638, 0.00024999687477100444], [-0.04999937495420089, 0.0, 0.00024999687477100444], [-0.03535489712587638, -0.03535489712587638, 0.00024999687477100444], [0.0, -0.04999937495420089, 0.00024999687477100444], [0.03535489712587638, -0.03535489712587638, 0.00024999687477100444]], "<f8")
FACES_B = unpacked("c-l>miw=Mw2t_H>lnDR-Z`19xV7uGl%0og#>QY;J;8;?)z=!;C;VHa(PimCB!Uc9z+2iT`hMoC)&OjY+vg?bE*YGEbbjxN#j@OxM?DbSLc@NmQOH+-~XZ-Vo2l)$mp8|6", "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.7540765426538162, 0.08100822275193517, -0.6120621274590657, -0.22402273946214168]
R, S = [0.0168, 0.029, 0.002692], [-0.3360184815247398, -0.440024201996683, -0.2130117159665761, -0.8050442786530224]


def touching():
    colliders, narrow = rapier3d.ColliderSet(), rapier3d.NarrowPhase()
    middle = (np.array(P) + R) / 2  # single precision has few digits to lose
    for vertices, faces, place, quaternion in ((A, FACES_A, P, Q), (B, FACES_B, R, S)):
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
normal = [Fraction(part) for part in [-0.8867880179676475, -0.39640447010743185, -0.23763523995371047]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 0.000176 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version is right")
