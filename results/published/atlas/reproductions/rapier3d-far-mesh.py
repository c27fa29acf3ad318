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
A = np.array([[0.49999374954200887, 0.0, -0.0024999687477100445], [0.35354897125876383, 0.35354897125876383, -0.0024999687477100445], [0.0, 0.49999374954200887, -0.0024999687477100445], [-0.35354897125876383, 0.35354897125876383, -0.0024999687477100445], [-0.49999374954200887, 0.0, -0.0024999687477100445], [-0.35354897125876383, -0.35354897125876383, -0.0024999687477100445], [0.0, -0.49999374954200887, -0.0024999687477100445], [0.35354897125876383, -0.35354897125876383, -0.0024999687477100445], [0.49999374954200887, 0.0, 0.0024999687477100445], [0.35354897125876383, 0.35354897125876383, 0.0024999687477100445], [0.0, 0.49999374954200887, 0.0024999687477100445], [-0.35354897125876383, 0.35354897125876383, 0.0024999687477100445], [-0.49999374954200887, 0.0, 0.0024999687477100445], [-0.35354897125876383, -0.35354897125876383, 0.0024999687477100445], [0.0, -0.49999374954200887, 0.0024999687477100445], [0.35354897125876383, -0.35354897125876383, 0.0024999687477100445]], "<f8")
FACES_A = unpacked("c-k$FNeTcl48z=gZ~y<>Nf-r8jC_$K1<TNX{yQvMCVjFwOO{1nY|gS}(>I&5Vmb7~=B!#S{jxc0mPdbV4ZlwBY{DbJ20p?g!Y4k$Bf%Fw!Xv{sKEk8G4?e=9!Y@7_eIEi@", "<i4")
B = np.array([[0.49999374954200887, 0.0, -0.0024999687477100445], [0.35354897125876383, 0.35354897125876383, -0.0024999687477100445], [0.0, 0.49999374954200887, -0.0024999687477100445], [-0.35354897125876383, 0.35354897125876383, -0.0024999687477100445], [-0.49999374954200887, 0.0, -0.0024999687477100445], [-0.35354897125876383, -0.35354897125876383, -0.0024999687477100445], [0.0, -0.49999374954200887, -0.0024999687477100445], [0.35354897125876383, -0.35354897125876383, -0.0024999687477100445], [0.49999374954200887, 0.0, 0.0024999687477100445], [0.35354897125876383, 0.35354897125876383, 0.0024999687477100445], [0.0, 0.49999374954200887, 0.0024999687477100445], [-0.35354897125876383, 0.35354897125876383, 0.0024999687477100445], [-0.49999374954200887, 0.0, 0.0024999687477100445], [-0.35354897125876383, -0.35354897125876383, 0.0024999687477100445], [0.0, -0.49999374954200887, 0.0024999687477100445], [0.35354897125876383, -0.35354897125876383, 0.0024999687477100445]], "<f8")
FACES_B = unpacked("c-k$FNeTcl48z=gZ~y<>Nf-r8jC_$K1<TNX{yQvMCVjFwOO{1nY|gS}(>I&5Vmb7~=B!#S{jxc0mPdbV4ZlwBY{DbJ20p?g!Y4k$Bf%Fw!Xv{sKEk8G4?e=9!Y@7_eIEi@", "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.0719685925625243, -0.48278930844026724, 0.47579236194113295, 0.7316806910523305]
R, S = [0.1, 0.011, 0.9576], [0.1199795452311585, -0.2079645450673414, -0.6788842600996386, -0.6938817032535334]


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
normal = [Fraction(part) for part in [-0.07613830888933229, 0.001339160774789725, -0.9970963667408943]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("rapier3d", version('rapier3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 0.00103 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
