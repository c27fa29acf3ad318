"""py-parry3d: separate hulls of which it says the opposite (at rest). Needs numpy and py-parry3d alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import py_parry3d

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 1 m
A = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_A = unpacked("c-lpb2@1e42n4-qO#J_UD|AAI0U6zO5sBfz9$dcBVL{@0c;uhN1-{|n1aA=Z8$Q^T-%YmYUhGA0a&MfIxj%+0vI>TK0h%lUO8", "<i4")
B = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_B = unpacked("c-lpb2@1e42n4-qO#J_UD|AAI0U6zO5sBfz9$dcBVL{@0c;uhN1-{|n1aA=Z8$Q^T-%YmYUhGA0a&MfIxj%+0vI>TK0h%lUO8", "<i4")
P, Q = [0.0, 0.0, 0.0], [0.4404193412468991, -0.8670948912768013, 0.02679862286799386, 0.23121221245794701]
R, S = [-0.046011, -0.496987803, 0.157270503], [-0.5487156583840961, -0.4939132777460865, 0.6655901898731166, 0.10931833997501914]


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
normal = [Fraction(part) for part in [0.1907489661941523, 0.4291983660096174, -0.882838373945388]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("py-parry3d", version('py-parry3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 4.93e-09 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
