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
P, Q = [0.0, 0.0, 0.0], [0.09063297808426882, 0.857753792588725, 0.09169297782795295, -0.4976308796691356]
R, S = [-0.2969970703125, 1.1817236328125, -0.075390625], [-0.21531004908531406, 0.05033001147398568, -0.9713052214333332, -0.08760501997175671]


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
normal = [Fraction(part) for part in [-0.3723132349587948, -0.9222794274878451, 0.10384369363235305]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("py-parry3d", version('py-parry3d'), "says", "they touch" if said else "they do not touch")
print("exactly, they are 3.39e-06 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
