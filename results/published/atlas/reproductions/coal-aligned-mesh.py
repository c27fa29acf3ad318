"""coal: separate meshs of which it says the opposite (at rest). Needs numpy and coal alone."""

import base64
import zlib
from fractions import Fraction

import numpy as np
import coal

def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of 1 m
A = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_A = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
B = np.array([[0.004999750018748438, 0.0, -0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, -0.49997500187484384], [-0.004999750018748438, 0.0, -0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, -0.49997500187484384], [0.004999750018748438, 0.0, 0.49997500187484384], [0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.002499875009374219, 0.0043299105098866236, 0.49997500187484384], [-0.004999750018748438, 0.0, 0.49997500187484384], [-0.002499875009374219, -0.0043299105098866236, 0.49997500187484384], [0.002499875009374219, -0.0043299105098866236, 0.49997500187484384]], "<f8")
FACES_B = unpacked("c-k$E2?_u)2m{m0s{Q|eSJ^3qh6#+4G%8pB>)&9r;&f+gwkkmnwr0DM^ki#xDv$oy4)=_1Y{ENW7r*dMxZ@Yz1rPkfyWxrd1CUe!KL", "<i4")
P, Q = [0.0, 0.0, 0.0], [0.5786819020065177, 0.29689071488808555, -0.11669635037871195, -0.7505765260862143]
R, S = [-0.001545, -0.0094, -0.003115423], [0.5786819020065177, 0.29689071488808555, -0.11669635037871195, -0.7505765260862143]


def touching():
    def body(vertices, faces, position, quaternion):
        points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
        for vertex in vertices:
            points.append(vertex)
        for face in faces.tolist():
            triangles.append(coal.Triangle(*face))
        shape = coal.BVHModelOBBRSS()
        shape.beginModel(len(faces), len(vertices))
        shape.addSubModel(points, triangles)
        shape.endModel()
        turned = coal.Quaternion(*quaternion).toRotationMatrix()
        return coal.CollisionObject(shape, coal.Transform3s(turned, np.array(position)))

    request = coal.CollisionRequest()
    request.gjk_tolerance = 1e-12
    return bool(coal.collide(body(A, FACES_A, P, Q), body(B, FACES_B, R, S), request, coal.CollisionResult()))


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
normal = [Fraction(part) for part in [0.25377585687297805, 0.8921571821702471, 0.37370225684417563]]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])
said = touching()
print("coal", coal.__version__, "says", "they touch" if said else "they do not touch")
print("exactly, they are 2.33e-05 apart, which is checked")
print("reproduced" if said != False else "not reproduced: this version answers otherwise")
