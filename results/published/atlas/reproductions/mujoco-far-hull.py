"""mujoco: overlapping hulls of which it says the opposite (at rest). Needs numpy and mujoco alone."""

from fractions import Fraction

import numpy as np
import mujoco

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 1 m
A = np.array([[-0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, 0.2886751345948129], [0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [0.2886751345948129, 0.2886751345948129, 0.2886751345948129]], "<f8")
FACES_A = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
B = np.array([[-0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, 0.2886751345948129], [0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [0.2886751345948129, 0.2886751345948129, 0.2886751345948129]], "<f8")
FACES_B = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]], "<i4")
P, Q = [-267.24, -396.53, -878.3], [0.2764146334382343, 0.13777260555546705, 0.2132101019957656, -0.9269062045248265]
R, S = [-266.8, -396.9, -878.44], [-0.37849234160072187, -0.3475588200398261, 0.8572513926368184, 0.03265675710112739]


def touching():
    spec = mujoco.MjSpec()
    spec.option.ccd_tolerance, spec.option.ccd_iterations = 1e-12, 200
    for name, vertices in (("a", A), ("b", B)):
        body = spec.worldbody.add_body()
        body.add_freejoint()
        spec.add_mesh(name=name, uservert=vertices.ravel(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, mass=1.0)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = [*P, *Q, *R, *S]
    mujoco.mj_kinematics(model, data)
    mujoco.mj_collision(model, data)
    return data.ncon > 0


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
weights = [[3, '8687195077730878329548300229938627578819990750973/18624152189513896550921982748980928787468897282554'], [6, '7148760863845183450356974847761085350626307153661/18624152189513896550921982748980928787468897282554'], [0, '24877714811211947273200998821584789678599361789/18624152189513896550921982748980928787468897282554'], [2, '2763318533126622823743506672459631068344000016131/18624152189513896550921982748980928787468897282554']], [[3, '8687195077730878329548300229938627578819990750973/18624152189513896550921982748980928787468897282554'], [6, '7148760863845183450356974847761085350626307153661/18624152189513896550921982748980928787468897282554'], [5, '24877714811211947273200998821584789678599361789/18624152189513896550921982748980928787468897282554'], [7, '2763318533126622823743506672459631068344000016131/18624152189513896550921982748980928787468897282554']]
assert all(Fraction(share) > 0 for side in weights for _, share in side)
assert all(sum(Fraction(share) for _, share in side) == 1 for side in weights)
mean = [[sum(Fraction(share) * points[k][axis] for k, share in side) for axis in range(3)]
        for side, points in zip(weights, (one, other))]
assert mean[0] == mean[1]
said = touching()
print("mujoco", mujoco.__version__, "says", "they touch" if said else "they do not touch")
print("exactly, they overlap by 0.00154, which is checked")
print("reproduced" if said != True else "not reproduced: this version answers otherwise")
