"""python-fcl: two meshs, of which it tells too early when they meet (case 1614 of the set). Needs numpy and python-fcl alone."""

from fractions import Fraction

import numpy as np
from importlib.metadata import version
import fcl

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 0.03125 m
A = np.array([[-15.8146848502048, -15.8146848502048, -15.8146848502048], [-15.8146848502048, -15.8146848502048, 15.8146848502048], [-15.8146848502048, 15.8146848502048, -15.8146848502048], [-15.8146848502048, 15.8146848502048, 15.8146848502048], [15.8146848502048, -15.8146848502048, -15.8146848502048], [15.8146848502048, -15.8146848502048, 15.8146848502048], [15.8146848502048, 15.8146848502048, -15.8146848502048], [15.8146848502048, 15.8146848502048, 15.8146848502048]], "<f8")
FACES_A = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
B = np.array([[-9.23760352, -9.23760352, -9.23760352], [-9.23760352, -9.23760352, 9.23760352], [-9.23760352, 9.23760352, -9.23760352], [-9.23760352, 9.23760352, 9.23760352], [9.23760352, -9.23760352, -9.23760352], [9.23760352, -9.23760352, 9.23760352], [9.23760352, 9.23760352, -9.23760352], [9.23760352, 9.23760352, 9.23760352]], "<f8")
FACES_B = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
P, Q = [-34.111424, -20.277568, 66.760608], [0.7238990971168616, 0.10762701443902598, 0.026973003618644464, 0.6809250913515545]
R, S = [-27.972992, -6.777024, -3.909152], [-0.2847479165478013, -0.8576837486352299, -0.24812792728016647, -0.3488978977471125]
V, W, X, Y = [-12.602144, -33.473408, -75.65696], [-0.625827, 6.103002, -0.360622], [7.181504, -24.299936, -24.503008], [5.276269, 1.426323, 4.580216]  # velocities and spins
DURATION, T = 4.0, 0.9292929292929293  # of the motion, and a moment
AT = [[-45.82250731313131, -51.38416937373737, -3.5468699797979752], [-0.687672259285241, 0.06720235747781897, 0.1947601318245593, -0.6961746892918731]], [[-21.29927111111111, -29.358782707070706, -26.67962408080808], [0.12525168446303675, 0.8657596409800793, 0.30426302803202687, 0.3770892061064573]]  # then


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
normal = [Fraction(part) for part in [-0.6322394043456809, -0.16323965762648518, 0.7573811126312872]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = first_touch()
print("python-fcl", version('python-fcl'), "says", "never" if said is None else f"at {said:.9g} s")
print("exactly, they are apart by 5.84 at 0.929292929 s, which is checked")
print("reproduced" if said is not None and abs(said - T) <= 1e-6 * DURATION else "not reproduced: this version answers otherwise")
