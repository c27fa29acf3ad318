"""rapier3d: separate hulls of which it says the opposite (at rest). Needs numpy and rapier3d alone."""

from fractions import Fraction

import numpy as np
from importlib.metadata import version
import rapier3d

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 1 m
A = np.array([[-0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, 0.2886751345948129], [0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [0.2886751345948129, 0.2886751345948129, 0.2886751345948129]], "<f8")
FACES_A = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
B = np.array([[-0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, 0.2886751345948129], [0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [0.2886751345948129, 0.2886751345948129, 0.2886751345948129]], "<f8")
FACES_B = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
P, Q = [0.0, 0.0, 0.0], [0.3305360753554578, -0.8125461852438942, -0.24902305677215844, 0.410490093583337]
R, S = [0.232, 0.4, -0.3623], [0.4231080371376749, -0.7684170674466585, -0.19941401750326707, 0.43674803833490566]


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
normal = [Fraction(part) for part in [-0.538970401267637, -0.676049479522458, 0.5024619466136874]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 0.000152 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version is right")
