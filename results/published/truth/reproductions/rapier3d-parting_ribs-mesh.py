"""rapier3d: two meshs, of which it tells too early when they meet (case 5593 of the set). Needs numpy and rapier3d alone."""

from fractions import Fraction

import numpy as np
from importlib.metadata import version
import rapier3d

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 1 m
A = np.array([[-0.28867511, -0.28867511, -0.28867511], [-0.28867511, -0.28867511, 0.28867511], [-0.28867511, 0.28867511, -0.28867511], [-0.28867511, 0.28867511, 0.28867511], [0.28867511, -0.28867511, -0.28867511], [0.28867511, -0.28867511, 0.28867511], [0.28867511, 0.28867511, -0.28867511], [0.28867511, 0.28867511, 0.28867511]], "<f8")
FACES_A = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
B = np.array([[-0.28867511, -0.28867511, -0.28867511], [-0.28867511, -0.28867511, 0.28867511], [-0.28867511, 0.28867511, -0.28867511], [-0.28867511, 0.28867511, 0.28867511], [0.28867511, -0.28867511, -0.28867511], [0.28867511, -0.28867511, 0.28867511], [0.28867511, 0.28867511, -0.28867511], [0.28867511, 0.28867511, 0.28867511]], "<f8")
FACES_B = np.array([[1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4], [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6]], "<i4")
P, Q = [0.543727, -0.084128, -0.60244], [-0.07996295318318393, -0.37990677757167507, 0.8864564809962817, -0.2519358524962623]
R, S = [0.042175, -0.668978, -0.982543], [0.8013567658163412, -0.23478693138728593, 0.03796098890650999, -0.5488728396007181]
V, W, X, Y = [0.918118, 1.069459, -0.26561], [1.231916, -1.916247, 0.410281], [0.84731, 0.986891, -0.319272], [10.234536, 10.48249, 5.653638]  # velocities and spins
DURATION, T = 1.0, 0.0009312663460150361  # of the motion, and a moment
AT = [[0.5445820123950706, -0.0831320488248571, -0.602687353654165], [-0.07890589761329062, -0.3798969800314578, 0.8865992526023462, -0.25178147106127574]], [[0.042964071287642, -0.6680589416245148, -0.982840327268825], [0.8037138410741652, -0.2337407457279203, 0.04386893346353168, -0.5454217103573525]]  # then


def times(p, q):
    vector = np.multiply(p[0], q[1:]) + np.multiply(q[0], p[1:]) + np.cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - np.dot(p[1:], q[1:]), *vector])


def moved(place, turn, velocity, spin, t):
    turned = np.sinc(np.linalg.norm(spin) * t / 2 / np.pi) * t / 2 * np.array(spin)
    return place + t * np.array(velocity), times([np.cos(np.linalg.norm(spin) * t / 2), *turned], turn)



def first_touch():
    colliders, bodies = rapier3d.ColliderSet(), rapier3d.RigidBodySet()
    one, other = [rapier3d.SharedShape.trimesh(vertices.tolist(), faces.tolist()) for vertices, faces in ((A, FACES_A), (B, FACES_B))]
    colliders.insert(rapier3d.Collider.new(one))
    world = rapier3d.QueryPipeline(rapier3d.BroadPhaseBvh(), rapier3d.NarrowPhase(), bodies, colliders)
    world.update(bodies, colliders)
    parts = max(1, int(np.ceil(np.linalg.norm(W) * DURATION / 0.02)))  # in which the one at rest turns by no more
    vector, options = rapier3d.Vec3, rapier3d.ShapeCastOptions()
    options.max_time_of_impact = length = DURATION / parts
    for start in np.arange(parts) * length:  # the other's motion in the axes of the first
        (place, turn), (at, facing) = moved(P, Q, V, W, start), moved(R, S, X, Y, start)
        back = turn * [1, -1, -1, -1]
        way = np.subtract(X, V) - np.cross(W, at - place)
        begin, way, spin = [times(times(back, [0, *v]), turn)[1:] for v in (at - place, way, np.subtract(Y, W))]
        motion = rapier3d.NonlinearRigidMotion(
            start=rapier3d.Isometry3(vector(*begin), rapier3d.Rotation3(*times(back, facing))),
            local_center=[0.0, 0.0, 0.0], linvel=vector(*way), angvel=vector(*spin))
        hit = world.cast_shape_nonlinear(motion, other, options, 0.0, length)
        if hit is not None:
            return start + hit[1].time_of_impact


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
normal = [Fraction(part) for part in [0.13860763996583725, 0.6583285398739949, 0.7398590782915857]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = first_touch()
print("rapier3d", version('rapier3d'), "says", "never" if said is None else f"at {said:.9g} s")
print("exactly, they are apart by 0.00033 at 0.000931266346 s, which is checked")
print("reproduced" if said is not None and abs(said - T) <= 1e-6 * DURATION else "not reproduced: this version answers otherwise")
