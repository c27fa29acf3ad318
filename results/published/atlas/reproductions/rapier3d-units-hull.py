"""rapier3d: separate hulls of which it says the opposite (at rest). Needs numpy and rapier3d alone."""

from fractions import Fraction

import numpy as np
from importlib.metadata import version
import rapier3d

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 8192 m
A = np.array([[-0.35238663890968375, -0.35238663890968375, -0.35238663890968375], [-0.35238663890968375, -0.35238663890968375, 0.35238663890968375], [-0.35238663890968375, 0.35238663890968375, -0.35238663890968375], [-0.35238663890968375, 0.35238663890968375, 0.35238663890968375], [0.35238663890968375, -0.35238663890968375, -0.35238663890968375], [0.35238663890968375, -0.35238663890968375, 0.35238663890968375], [0.35238663890968375, 0.35238663890968375, -0.35238663890968375], [0.35238663890968375, 0.35238663890968375, 0.35238663890968375]], "<f8")
FACES_A = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
B = np.array([[-0.35238663890968375, -0.35238663890968375, -0.35238663890968375], [-0.35238663890968375, -0.35238663890968375, 0.35238663890968375], [-0.35238663890968375, 0.35238663890968375, -0.35238663890968375], [-0.35238663890968375, 0.35238663890968375, 0.35238663890968375], [0.35238663890968375, -0.35238663890968375, -0.35238663890968375], [0.35238663890968375, -0.35238663890968375, 0.35238663890968375], [0.35238663890968375, 0.35238663890968375, -0.35238663890968375], [0.35238663890968375, 0.35238663890968375, 0.35238663890968375]], "<f8")
FACES_B = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
P, Q = [0.0, 0.0, 0.0], [0.7963800735194226, 0.5398410498365085, 0.11430201055201919, -0.24755902285390738]
R, S = [-0.46728515625, -0.115966796875, -0.5338134765625], [-0.5925428370305958, 0.7041228063423148, -0.0400809889763668, -0.38922689294938545]


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
normal = [Fraction(part) for part in [0.5177113582953845, 0.29457254018736323, 0.8032446501904088]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 8.86e-05 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
