"""py-parry3d: separate hulls of which it says the opposite (at rest). Needs numpy and py-parry3d alone."""

from fractions import Fraction

import numpy as np
from importlib.metadata import version
import py_parry3d

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 0.00012207 m
A = np.array([[-0.23648267026007075, -0.23648267026007075, -0.23648267026007075], [-0.23648267026007075, -0.23648267026007075, 0.23648267026007075], [-0.23648267026007075, 0.23648267026007075, -0.23648267026007075], [-0.23648267026007075, 0.23648267026007075, 0.23648267026007075], [0.23648267026007075, -0.23648267026007075, -0.23648267026007075], [0.23648267026007075, -0.23648267026007075, 0.23648267026007075], [0.23648267026007075, 0.23648267026007075, -0.23648267026007075], [0.23648267026007075, 0.23648267026007075, 0.23648267026007075]], "<f8")
FACES_A = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
B = np.array([[-0.23648267026007075, -0.23648267026007075, -0.23648267026007075], [-0.23648267026007075, -0.23648267026007075, 0.23648267026007075], [-0.23648267026007075, 0.23648267026007075, -0.23648267026007075], [-0.23648267026007075, 0.23648267026007075, 0.23648267026007075], [0.23648267026007075, -0.23648267026007075, -0.23648267026007075], [0.23648267026007075, -0.23648267026007075, 0.23648267026007075], [0.23648267026007075, 0.23648267026007075, -0.23648267026007075], [0.23648267026007075, 0.23648267026007075, 0.23648267026007075]], "<f8")
FACES_B = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
P, Q = [0.0, 0.0, 0.0], [0.2826045866531889, 0.951830644919931, 0.0838145293454719, -0.08442864244132843]
R, S = [-0.3436868595048847, -0.13055508404278085, -0.43815779595374194], [0.2286276835526681, 0.18380093333076358, 0.8507628548627834, 0.4360609636344533]


def touching():
    def turned(place, quaternion):
        (w, x, y, z), pose = quaternion, np.eye(4)
        pose[:3, :3] = [[x * x - y * y - z * z + w * w, 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), -x * x - y * y + z * z + w * w]]
        pose[:3, 3] = place
        return pose
    import trimesh
    hull = py_parry3d.ConvexHull_from_trimesh
    solids = {"a": trimesh.Trimesh(A, FACES_A, process=False), "b": trimesh.Trimesh(B, FACES_B, process=False)}
    shapes = {name: hull(solid) for name, solid in solids.items()}
    world = py_parry3d.CollisionWorld([py_parry3d.CollisionGroup(name, [shape]) for name, shape in shapes.items()])
    return bool(world.check({"a": turned(P, Q), "b": turned(R, S)}, [("a", "b", 0.0)])[0])


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
normal = [Fraction(part) for part in [0.11335079752687051, 0.5521361058018646, 0.8260129038761893]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("py-parry3d", version('py-parry3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 8.19e-09 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version is right")
