"""python-fcl: two meshs, of which it tells too early when they meet (case 7438 of the set). Needs numpy and python-fcl alone."""

from fractions import Fraction

import numpy as np
from importlib.metadata import version
import fcl

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 0.03125 m
A = np.array([[-9.23760352, -9.23760352, -9.23760352], [-9.23760352, -9.23760352, 9.23760352], [-9.23760352, 9.23760352, -9.23760352], [-9.23760352, 9.23760352, 9.23760352], [9.23760352, -9.23760352, -9.23760352], [9.23760352, -9.23760352, 9.23760352], [9.23760352, 9.23760352, -9.23760352], [9.23760352, 9.23760352, 9.23760352]], "<f8")
FACES_A = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
B = np.array([[-9.23760352, -9.23760352, -9.23760352], [-9.23760352, -9.23760352, 9.23760352], [-9.23760352, 9.23760352, -9.23760352], [-9.23760352, 9.23760352, 9.23760352], [9.23760352, -9.23760352, -9.23760352], [9.23760352, -9.23760352, 9.23760352], [9.23760352, 9.23760352, -9.23760352], [9.23760352, 9.23760352, 9.23760352]], "<f8")
FACES_B = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
P, Q = [18.536288, 10.247392, 7.247616], [0.14817505481796436, 0.09035503342721223, -0.9193013400992709, -0.35322113067559435]
R, S = [48.890592, 16.729312, -22.648832], [-0.036334995534447495, 0.6374349216595717, 0.535669934166437, -0.5526429320804642]
V, W, X, Y = [-0.913024, 22.289728, 5.529056], [-70.639601, -32.377691, -62.942291], [-490.440064, -141.031552, 97.692288], [-50.396526, 130.020683, 265.621558]  # velocities and spins
DURATION, T = 0.5, 0.045454545454545456  # of the motion, and a moment
AT = [[18.49478690909091, 11.260561454545455, 7.498936727272727], [-0.4439884856690529, -0.49277839762341513, 0.32299770501492736, 0.6750675210555539]], [[26.597861818181816, 10.318786909090909, -18.208273454545452], [0.15444244510335686, 0.18755515129512304, 0.6932066525393645, -0.6785537069741268]]  # then


def times(p, q):
    vector = np.multiply(p[0], q[1:]) + np.multiply(q[0], p[1:]) + np.cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - np.dot(p[1:], q[1:]), *vector])


def moved(place, turn, velocity, spin, t):
    turned = np.sinc(np.linalg.norm(spin) * t / 2 / np.pi) * t / 2 * np.array(spin)
    return place + t * np.array(velocity), times([np.cos(np.linalg.norm(spin) * t / 2), *turned], turn)



def first_touch():
    def body(vertices, faces, position, quaternion):
        model = fcl.BVHModel()
        model.beginModel(len(vertices), len(faces))
        model.addSubModel(vertices, faces)
        model.endModel()
        return fcl.CollisionObject(model, fcl.Transform(quaternion, position))

    request, result = fcl.ContinuousCollisionRequest(
        num_max_iterations=100, toc_err=0.01, ccd_motion_type=fcl.CCDMotionType.CCDM_TRANS,
        ccd_solver_type=fcl.CCDSolverType.CCDC_NAIVE), fcl.ContinuousCollisionResult()
    ends = [fcl.Transform(turn, place) for place, turn in (moved(P, Q, V, W, DURATION), moved(R, S, X, Y, DURATION))]
    fcl.continuousCollide(body(A, FACES_A, P, Q), ends[0], body(B, FACES_B, R, S), ends[1], request, result)
    return DURATION * result.time_of_contact if result.is_collide else None


def exact(points, position, quaternion):
    """The points in the world, as fractions."""
    w, x, y, z = map(Fraction, quaternion)
    n = w * w + x * x + y * y + z * z
    rows = [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]]
    return [[Fraction(t) + sum(r * Fraction(c) for r, c in zip(row, point)) / n for row, t in zip(rows, position)]
            for point in points.tolist()]


for told, now in zip(AT, (moved(P, Q, V, W, T), moved(R, S, X, Y, T))):
    assert all(np.allclose(a, b, rtol=0, atol=1e-13 * (1 + np.abs(b).max())) for a, b in zip(told, now))
one, other = exact(A, *AT[0]), exact(B, *AT[1])
# along this direction every point of the first lies farther than every point of the second
normal = [Fraction(part) for part in [-0.46962394446967426, -0.008775863948669088, 0.8828229352439246]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = first_touch()
print("python-fcl", version('python-fcl'), "says", "never" if said is None else f"at {said:.9g} s")
print("exactly, they are apart by 2.2 at 0.0454545455 s, which is checked")
print("reproduced" if said is not None and abs(said - T) <= 1e-6 * DURATION else "not reproduced: this version answers otherwise")
