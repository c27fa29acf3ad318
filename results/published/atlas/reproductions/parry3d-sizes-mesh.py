"""py-parry3d: separate meshs of which it says the opposite (at rest). Needs numpy and py-parry3d alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import py_parry3d

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 4096 m
A = np.array([[1.220687865092795, 0.0, -0.006103439325463976], [0.8631566681122164, 0.8631566681122164, -0.006103439325463976], [0.0, 1.220687865092795, -0.006103439325463976], [-0.8631566681122164, 0.8631566681122164, -0.006103439325463976], [-1.220687865092795, 0.0, -0.006103439325463976], [-0.8631566681122164, -0.8631566681122164, -0.006103439325463976], [0.0, -1.220687865092795, -0.006103439325463976], [0.8631566681122164, -0.8631566681122164, -0.006103439325463976], [1.220687865092795, 0.0, 0.006103439325463976], [0.8631566681122164, 0.8631566681122164, 0.006103439325463976], [0.0, 1.220687865092795, 0.006103439325463976], [-0.8631566681122164, 0.8631566681122164, 0.006103439325463976], [-1.220687865092795, 0.0, 0.006103439325463976], [-0.8631566681122164, -0.8631566681122164, 0.006103439325463976], [0.0, -1.220687865092795, 0.006103439325463976], [0.8631566681122164, -0.8631566681122164, 0.006103439325463976]], "<f8")
FACES_A = unpacked("c-k$FNeTcl48z=gZ~y<>Nf-r8jC_$K1<TNX{yQvMCVjFwOO{1nY|gS}(>I&5Vmb7~=B!#S{jxc0mPdbV4ZlwBY{DbJ20p?g!Y4k$Bf%Fw!Xv{sKEk8G4?e=9!Y@7_eIEi@", "<i4")
B = np.array([[0.00012206878650927951, 0.0, -6.103439325463976e-07], [8.631566681122164e-05, 8.631566681122164e-05, -6.103439325463976e-07], [0.0, 0.00012206878650927951, -6.103439325463976e-07], [-8.631566681122164e-05, 8.631566681122164e-05, -6.103439325463976e-07], [-0.00012206878650927951, 0.0, -6.103439325463976e-07], [-8.631566681122164e-05, -8.631566681122164e-05, -6.103439325463976e-07], [0.0, -0.00012206878650927951, -6.103439325463976e-07], [8.631566681122164e-05, -8.631566681122164e-05, -6.103439325463976e-07], [0.00012206878650927951, 0.0, 6.103439325463976e-07], [8.631566681122164e-05, 8.631566681122164e-05, 6.103439325463976e-07], [0.0, 0.00012206878650927951, 6.103439325463976e-07], [-8.631566681122164e-05, 8.631566681122164e-05, 6.103439325463976e-07], [-0.00012206878650927951, 0.0, 6.103439325463976e-07], [-8.631566681122164e-05, -8.631566681122164e-05, 6.103439325463976e-07], [0.0, -0.00012206878650927951, 6.103439325463976e-07], [8.631566681122164e-05, -8.631566681122164e-05, 6.103439325463976e-07]], "<f8")
FACES_B = unpacked("c-k$FNeTcl48z=gZ~y<>Nf-r8jC_$K1<TNX{yQvMCVjFwOO{1nY|gS}(>I&5Vmb7~=B!#S{jxc0mPdbV4ZlwBY{DbJ20p?g!Y4k$Bf%Fw!Xv{sKEk8G4?e=9!Y@7_eIEi@", "<i4")
P, Q = [0.0, 0.0, 0.0], [-0.10544694803053721, -0.011496994333713489, 0.5727837177039007, 0.8128145994048299]
R, S = [-1.1941552734375, -0.2197021484375, 0.126708984375], [-0.817733779510791, 0.367840900817416, 0.2742839260436007, -0.34752390629557794]


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
normal = [Fraction(part) for part in [0.7227997656223369, -0.39674616750711067, -0.5658206229757929]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("py-parry3d", version('py-parry3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 2.32e-05 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version is right")
