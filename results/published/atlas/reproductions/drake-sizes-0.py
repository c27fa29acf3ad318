"""drake: overlapping hulls of which it says the opposite (at rest). Needs numpy and drake alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
from importlib.metadata import version
import pydrake.all as drake

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 64 m
A = np.array([[0.007812109404294435, 0.0, -0.7812109404294435], [0.0039060547021472175, 0.006765485171697849, -0.7812109404294435], [-0.0039060547021472175, 0.006765485171697849, -0.7812109404294435], [-0.007812109404294435, 0.0, -0.7812109404294435], [-0.0039060547021472175, -0.006765485171697849, -0.7812109404294435], [0.0039060547021472175, -0.006765485171697849, -0.7812109404294435], [0.007812109404294435, 0.0, 0.7812109404294435], [0.0039060547021472175, 0.006765485171697849, 0.7812109404294435], [-0.0039060547021472175, 0.006765485171697849, 0.7812109404294435], [-0.007812109404294435, 0.0, 0.7812109404294435], [-0.0039060547021472175, -0.006765485171697849, 0.7812109404294435], [0.0039060547021472175, -0.006765485171697849, 0.7812109404294435]], "<f8")
FACES_A = unpacked("c-lpb2@1e42n4-qO#J_UD|AAI0U6zO5sBfz9$dcBVL{@0c;uhN1-{|n1aA=Z8$Q^T-%YmYUhGA0a&MfIxj%+0vI>TK0h%lUO8", "<i4")
B = np.array([[7.812109404294435e-05, 0.0, -0.007812109404294435], [3.9060547021472175e-05, 6.765485171697849e-05, -0.007812109404294435], [-3.9060547021472175e-05, 6.765485171697849e-05, -0.007812109404294435], [-7.812109404294435e-05, 0.0, -0.007812109404294435], [-3.9060547021472175e-05, -6.765485171697849e-05, -0.007812109404294435], [3.9060547021472175e-05, -6.765485171697849e-05, -0.007812109404294435], [7.812109404294435e-05, 0.0, 0.007812109404294435], [3.9060547021472175e-05, 6.765485171697849e-05, 0.007812109404294435], [-3.9060547021472175e-05, 6.765485171697849e-05, 0.007812109404294435], [-7.812109404294435e-05, 0.0, 0.007812109404294435], [-3.9060547021472175e-05, -6.765485171697849e-05, 0.007812109404294435], [3.9060547021472175e-05, -6.765485171697849e-05, 0.007812109404294435]], "<f8")
FACES_B = unpacked("c-lpb2@1e42n4-qO#J_UD|AAI0U6zO5sBfz9$dcBVL{@0c;uhN1-{|n1aA=Z8$Q^T-%YmYUhGA0a&MfIxj%+0vI>TK0h%lUO8", "<i4")
P, Q = [0.0, 0.0, 0.0], [0.123017985359371, 0.1874349064671934, -0.6589881729570092, 0.7179619203123095]
R, S = [-0.08221669679934868, 0.7735840197399245, -0.05780485801827944], [0.8070980392349265, -0.24906752910567517, -0.36477203723402823, 0.3917900992374201]


def touching():
    scene, poses = drake.SceneGraph(), drake.FramePoseVector()
    source = scene.RegisterSource("bodies")
    for name, points, faces, place, turn in (("a", A, FACES_A, P, Q), ("b", B, FACES_B, R, S)):
        lines = ["v %r %r %r" % (*v,) for v in points.tolist()] + ["f %d %d %d" % (*f,) for f in faces + 1]
        mesh = drake.InMemoryMesh(mesh_file=drake.MemoryFile("\n".join([*lines, ""]), ".obj", "hull"))
        frame = scene.RegisterFrame(source, drake.GeometryFrame(name))
        instance = drake.GeometryInstance(drake.RigidTransform(), drake.Convex(mesh, 1.0), name)
        scene.AssignRole(source, scene.RegisterGeometry(source, frame, instance), drake.ProximityProperties())
        poses.set_value(frame, drake.RigidTransform(drake.Quaternion(turn / np.linalg.norm(turn)), place))
    context = scene.CreateDefaultContext()
    scene.get_source_pose_port(source).FixValue(context, poses)
    return bool(scene.get_query_output_port().Eval(context).ComputePointPairPenetration())


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
# the same point is a mean of vertices of both, with positive weights
weights = [[1, '794529194119181910966632362499270921075461234885106202246321476569282/166814631065812972661112091372992075405355582671354589836361914919435717633115267'], [1, '2174633113873497231026624851593962863904796921256186203974217371343947/16681463106581297150354519078337395010517774957630876114948333182351453262150830912'], [2, '2607860139019026671470467699106961175153835156550078337715754192044167542718349669/11120975404387531433569679385558263340345183305087250743298888788234302174767220608'], [1, '147216944245461236402534202671058402216412716621416914385051930822834562657486289757269690269774659/192314559951216818807722405000379715322327798890098887814644842352033893897363171426074155646235264']], [[11, '794529194119181910966632362499270921075461234885106202246321476569282/166814631065812972661112091372992075405355582671354589836361914919435717633115267'], [4, '2174633113873497231026624851593962863904796921256186203974217371343947/16681463106581297150354519078337395010517774957630876114948333182351453262150830912'], [10, '2607860139019026671470467699106961175153835156550078337715754192044167542718349669/11120975404387531433569679385558263340345183305087250743298888788234302174767220608'], [10, '147216944245461236402534202671058402216412716621416914385051930822834562657486289757269690269774659/192314559951216818807722405000379715322327798890098887814644842352033893897363171426074155646235264']]
assert all(Fraction(share) > 0 for side in weights for _, share in side)
assert all(sum(Fraction(share) for _, share in side) == 1 for side in weights)
mean = [[sum(Fraction(share) * points[k][axis] for k, share in side) for axis in range(3)]
        for side, points in zip(weights, (one, other))]
assert mean[0] == mean[1]
said = touching()
print("drake", version('drake'), "says", "they touch" if said else "they do not touch")
print("exactly, they overlap by 2.07e-05, which is checked")
print("reproduced" if said != True else "not reproduced: this version is right")
