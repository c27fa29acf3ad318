"""rapier3d: separate meshs of which it says the opposite (at rest). Needs numpy and rapier3d alone."""

from fractions import Fraction

import numpy as np
from importlib.metadata import version
import rapier3d

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 64 m
A = np.array([[-0.45105489780439517, -0.45105489780439517, -0.45105489780439517], [-0.45105489780439517, -0.45105489780439517, 0.45105489780439517], [-0.45105489780439517, 0.45105489780439517, -0.45105489780439517], [-0.45105489780439517, 0.45105489780439517, 0.45105489780439517], [0.45105489780439517, -0.45105489780439517, -0.45105489780439517], [0.45105489780439517, -0.45105489780439517, 0.45105489780439517], [0.45105489780439517, 0.45105489780439517, -0.45105489780439517], [0.45105489780439517, 0.45105489780439517, 0.45105489780439517]], "<f8")
FACES_A = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
B = np.array([[-0.004510548978043952, -0.004510548978043952, -0.004510548978043952], [-0.004510548978043952, -0.004510548978043952, 0.004510548978043952], [-0.004510548978043952, 0.004510548978043952, -0.004510548978043952], [-0.004510548978043952, 0.004510548978043952, 0.004510548978043952], [0.004510548978043952, -0.004510548978043952, -0.004510548978043952], [0.004510548978043952, -0.004510548978043952, 0.004510548978043952], [0.004510548978043952, 0.004510548978043952, -0.004510548978043952], [0.004510548978043952, 0.004510548978043952, 0.004510548978043952]], "<f8")
FACES_B = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.718796609335266, -0.43387723011335944, 0.5428463962017378, -0.0199943424015373]
R, S = [-0.20703990625, -0.293378125, -0.6265625], [0.6542938439186958, -0.6592960904318357, 0.3441545601040234, 0.13706155446003263]


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
normal = [Fraction(part) for part in [-0.06386126870724398, 0.12784193445787315, 0.9897364185242301]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 0.000149 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
