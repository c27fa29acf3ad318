"""py-parry3d: separate hulls of which it says the opposite (at rest). Needs numpy and py-parry3d alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import py_parry3d

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 8192 m
A = np.array([[0.6103439325463975, 0.0, -0.003051719662731988], [0.4315783340561082, 0.4315783340561082, -0.003051719662731988], [0.0, 0.6103439325463975, -0.003051719662731988], [-0.4315783340561082, 0.4315783340561082, -0.003051719662731988], [-0.6103439325463975, 0.0, -0.003051719662731988], [-0.4315783340561082, -0.4315783340561082, -0.003051719662731988], [0.0, -0.6103439325463975, -0.003051719662731988], [0.4315783340561082, -0.4315783340561082, -0.003051719662731988], [0.6103439325463975, 0.0, 0.003051719662731988], [0.4315783340561082, 0.4315783340561082, 0.003051719662731988], [0.0, 0.6103439325463975, 0.003051719662731988], [-0.4315783340561082, 0.4315783340561082, 0.003051719662731988], [-0.6103439325463975, 0.0, 0.003051719662731988], [-0.4315783340561082, -0.4315783340561082, 0.003051719662731988], [0.0, -0.6103439325463975, 0.003051719662731988], [0.4315783340561082, -0.4315783340561082, 0.003051719662731988]], "<f8")
FACES_A = unpacked("c-l>miw=Mw2t_H>lnDR-Z`19xV7uGl%0og#>QY;J;8;?)z=!;C;VHa(PimCB!Uc9z+2iT`hMoC)&OjY+vg?bE*YGEbbjxN#j@OxM?DbSLc@NmQOH+-~XZ-Vo2l)$mp8|6", "<i4")
B = np.array([[0.6103439325463975, 0.0, -0.003051719662731988], [0.4315783340561082, 0.4315783340561082, -0.003051719662731988], [0.0, 0.6103439325463975, -0.003051719662731988], [-0.4315783340561082, 0.4315783340561082, -0.003051719662731988], [-0.6103439325463975, 0.0, -0.003051719662731988], [-0.4315783340561082, -0.4315783340561082, -0.003051719662731988], [0.0, -0.6103439325463975, -0.003051719662731988], [0.4315783340561082, -0.4315783340561082, -0.003051719662731988], [0.6103439325463975, 0.0, 0.003051719662731988], [0.4315783340561082, 0.4315783340561082, 0.003051719662731988], [0.0, 0.6103439325463975, 0.003051719662731988], [-0.4315783340561082, 0.4315783340561082, 0.003051719662731988], [-0.6103439325463975, 0.0, 0.003051719662731988], [-0.4315783340561082, -0.4315783340561082, 0.003051719662731988], [0.0, -0.6103439325463975, 0.003051719662731988], [0.4315783340561082, -0.4315783340561082, 0.003051719662731988]], "<f8")
FACES_B = unpacked("c-l>miw=Mw2t_H>lnDR-Z`19xV7uGl%0og#>QY;J;8;?)z=!;C;VHa(PimCB!Uc9z+2iT`hMoC)&OjY+vg?bE*YGEbbjxN#j@OxM?DbSLc@NmQOH+-~XZ-Vo2l)$mp8|6", "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.8329899181374429, -0.1100082434611867, -0.2644335828054256, -0.47339292658070675]
R, S = [-0.0385997802734375, 0.227690478515625, -0.0004237060546875], [-0.22631648785227737, 0.4902172022159756, 0.8232011669736697, -0.17552145359168939]


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
normal = [Fraction(part) for part in [0.5446952656279527, 0.06709045987060856, 0.8359461333105408]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("py-parry3d", version('py-parry3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 1.48e-08 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
