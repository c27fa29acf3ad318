"""python-fcl: the distance of two cubes is told as 0.827, and is at most 0.593. Needs numpy and python-fcl alone."""

from fractions import Fraction
from importlib.metadata import version

import fcl
import numpy as np

# vertices and triangles of either cube in its own frame, positions, quaternions w x y z
VERTICES = np.array([[-0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [-0.2886751345948129, 0.2886751345948129, 0.2886751345948129], [0.2886751345948129, -0.2886751345948129, -0.2886751345948129], [0.2886751345948129, -0.2886751345948129, 0.2886751345948129], [0.2886751345948129, 0.2886751345948129, -0.2886751345948129], [0.2886751345948129, 0.2886751345948129, 0.2886751345948129]])
FACES = np.array([[0, 2, 6], [6, 4, 0], [0, 4, 5], [5, 1, 0], [4, 6, 5], [5, 6, 7], [3, 2, 0], [0, 1, 3], [3, 6, 2], [7, 6, 3], [1, 5, 3], [3, 5, 7]])
P, Q = [0.0, 0.0, 0.0], [-0.43131528284302434, 0.4517999079464696, -0.249581355815069, 0.7399683214808019]
R, S = [-0.8939334438057029, -1.0091634557453266, 0.18304730614688092], [-0.43131528284302434, 0.4517999079464696, -0.249581355815069, 0.7399683214808019]
# a point of either, as a mean of its vertices with these weights
FIRST = [[4, '6750386909872605693714698586058128061682261028523/6750386909872605977450485033865518760831872340461'], [6, '283735786447807390699149611311938/6750386909872605977450485033865518760831872340461']]
SECOND = [[1, '6750386909872605693714698586058128061682261028523/6750386909872605977450485033865518760831872340461'], [1, '283735786447807390699149611311938/6750386909872605977450485033865518760831872340461']]


def told():
    def body(position, quaternion):
        counted = np.column_stack([np.full(len(FACES), 3), FACES]).ravel()
        cube = fcl.Convex(VERTICES, len(FACES), counted)
        return fcl.CollisionObject(cube, fcl.Transform(np.array(quaternion), np.array(position)))

    return fcl.distance(body(P, Q), body(R, S), fcl.DistanceRequest(), fcl.DistanceResult())


def point(weights, position, quaternion):
    """In the world, as fractions."""
    assert all(Fraction(share) > 0 for _, share in weights) and sum(Fraction(share) for _, share in weights) == 1
    w, x, y, z = map(Fraction, quaternion)
    n = w * w + x * x + y * y + z * z
    rows = [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]]
    mean = [sum(Fraction(share) * Fraction(VERTICES[k, axis]) for k, share in weights) for axis in range(3)]
    return [Fraction(t) + sum(r * c for r, c in zip(row, mean)) / n for row, t in zip(rows, position)]


squared = sum((a - b) ** 2 for a, b in zip(point(FIRST, P, Q), point(SECOND, R, S)))
said = told()
print("python-fcl", version("python-fcl"), "says that they are", said, "apart")
print("exactly, two points of them are", float(squared) ** 0.5, "apart, which is checked")
wrong = said > 0 and Fraction(said) ** 2 > Fraction(11, 10) * squared
print("reproduced" if wrong else "not reproduced: this version is right")
