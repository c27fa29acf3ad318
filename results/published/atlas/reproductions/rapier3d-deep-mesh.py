"""rapier3d: separate meshs of which it says the opposite (at rest). Needs numpy and rapier3d alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import rapier3d

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 1 m
A = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_A = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
B = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_B = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
P, Q = [0.0, 0.0, 0.0], [0.45069968676382655, 0.6426995533239658, 0.13559990575809824, 0.604499579872938]
R, S = [0.1501, -0.02, 0.0368], [-0.6125963029924671, 0.6450961068567427, -0.002099987326614726, 0.4566972438404501]


def touching():
    colliders, narrow = rapier3d.ColliderSet(), rapier3d.NarrowPhase()
    middle = (np.array(P) + R) / 2  # single precision has few digits to lose
    for vertices, faces, place, quaternion in ((A, FACES_A, P, Q), (B, FACES_B, R, S)):
        shape = rapier3d.SharedShape.trimesh(vertices.tolist(), faces.tolist())
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
normal = [Fraction(part) for part in [0.18254753611571392, 0.071541422940628, -0.9805907514665393]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 0.000125 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
