"""py-parry3d: separate meshs of which it says the opposite (at rest). Needs numpy and py-parry3d alone."""

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
FACES_A = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
B = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_B = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.4930936405328882, 0.6957064674778423, -0.273391476954938, 0.44509355545089907]
R, S = [0.443508398, 0.399245057, 0.247230514], [0.23304962152203731, 0.8159835525721306, 0.3089656975380495, -0.4294169460850687]


def touching():
    def turned(place, quaternion):
        (w, x, y, z), pose = quaternion, np.eye(4)
        pose[:3, :3] = [[x * x - y * y - z * z + w * w, 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), -x * x - y * y + z * z + w * w]]
        pose[:3, 3] = place
        return pose
    mesh = py_parry3d.TriMesh
    shapes = {"a": mesh(A, FACES_A.astype("u4")), "b": mesh(B, FACES_B.astype("u4"))}
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
normal = [Fraction(part) for part in [-0.36416072614258055, 0.5274587222934999, -0.7675768768089728]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("py-parry3d", version('py-parry3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 9.71e-09 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
