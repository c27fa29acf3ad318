"""py-parry3d: separate meshs of which it says the opposite (at rest). Needs numpy and py-parry3d alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import py_parry3d

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 0.00012207 m
A = np.array([[0.004095795215358721, 0.0, -0.40957952153587207], [0.0020478976076793603, 0.003547062689699122, -0.40957952153587207], [-0.0020478976076793603, 0.003547062689699122, -0.40957952153587207], [-0.004095795215358721, 0.0, -0.40957952153587207], [-0.0020478976076793603, -0.003547062689699122, -0.40957952153587207], [0.0020478976076793603, -0.003547062689699122, -0.40957952153587207], [0.004095795215358721, 0.0, 0.40957952153587207], [0.0020478976076793603, 0.003547062689699122, 0.40957952153587207], [-0.0020478976076793603, 0.003547062689699122, 0.40957952153587207], [-0.004095795215358721, 0.0, 0.40957952153587207], [-0.0020478976076793603, -0.003547062689699122, 0.40957952153587207], [0.0020478976076793603, -0.003547062689699122, 0.40957952153587207]], "<f8")
FACES_A = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
B = np.array([[0.004095795215358721, 0.0, -0.40957952153587207], [0.0020478976076793603, 0.003547062689699122, -0.40957952153587207], [-0.0020478976076793603, 0.003547062689699122, -0.40957952153587207], [-0.004095795215358721, 0.0, -0.40957952153587207], [-0.0020478976076793603, -0.003547062689699122, -0.40957952153587207], [0.0020478976076793603, -0.003547062689699122, -0.40957952153587207], [0.004095795215358721, 0.0, 0.40957952153587207], [0.0020478976076793603, 0.003547062689699122, 0.40957952153587207], [-0.0020478976076793603, 0.003547062689699122, 0.40957952153587207], [-0.004095795215358721, 0.0, 0.40957952153587207], [-0.0020478976076793603, -0.003547062689699122, 0.40957952153587207], [0.0020478976076793603, -0.003547062689699122, 0.40957952153587207]], "<f8")
FACES_B = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.257664790060901, 0.8838233616809567, 0.24914413542713973, -0.3006531574623952]
R, S = [0.154545717248, 0.30269681664, -0.103135141888], [0.6113518100669586, 0.06501217273875551, 0.6166651389832123, 0.49167721940970077]


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
normal = [Fraction(part) for part in [-0.7446797417214298, -0.14403855272364174, 0.6516939293863211]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("py-parry3d", version('py-parry3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 1.01e-08 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version is right")
