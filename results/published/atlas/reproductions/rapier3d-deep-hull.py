"""rapier3d: separate hulls of which it says the opposite (at rest). Needs numpy and rapier3d alone."""

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
FACES_A = unpacked("c-lpb2@1e42n4-qO#J_UD|AAI0U6zO5sBfz9$dcBVL{@0c;uhN1-{|n1aA=Z8$Q^T-%YmYUhGA0a&MfIxj%+0vI>TK0h%lUO8", "<i4")
B = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_B = unpacked("c-lpb2@1e42n4-qO#J_UD|AAI0U6zO5sBfz9$dcBVL{@0c;uhN1-{|n1aA=Z8$Q^T-%YmYUhGA0a&MfIxj%+0vI>TK0h%lUO8", "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.1479650104120672, -0.8817914809692112, -0.4308981046459524, 0.1219711572315689]
R, S = [-0.0082, 0.035, -0.002], [0.17900179002685043, -0.22500225003375057, -0.7170071701075518, -0.6350063500952516]


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
normal = [Fraction(part) for part in [0.9961259836284463, -0.03947322235317922, -0.0785804648581116]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 3.62e-05 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
