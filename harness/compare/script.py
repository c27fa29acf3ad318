"""A wrong verdict as a Python file that needs numpy and the library alone, for those who maintain the library.

It builds the two bodies, asks the library in the way that its documentation has, prints the answer and the truth, and
checks the proof of the truth with fractions. Lengths are in the unit that the library is told of, a power of two.
"""

from __future__ import annotations

import base64
import subprocess
import sys
import tempfile
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.compare.judge import judge
from harness.compare.library_calls import CALLS, Call
from harness.compare.outcome import Case
from harness.scene.mesh import Surface

LONGEST = 60
"""Lines."""
_SECONDS = 60.0
# Numbers that are written out; more of them are packed.
_FEW = 48

_TEXT = '''"""{library}: {state} {shape}s of which it says the opposite ({pose}). Needs numpy and {library} alone."""

{packing}from fractions import Fraction

import numpy as np
{imports}

{unpack}# vertices in each body's own frame, triangles, positions, quaternions w x y z; lengths in units of {unit:g} m
A = {first}
FACES_A = {faces}
B = {second}
FACES_B = {other_faces}
P, Q = {position}, {quaternion}
R, S = {other_position}, {other_quaternion}


def touching():
{ask}

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
{proof}
said = touching()
print("{library}", {version}, "says", "they touch" if said else "they do not touch")
print("exactly, they {truth}, which is checked")
print("reproduced" if said != {is_touching} else "not reproduced: this version is right")
'''

_COMMON = """# the same point is a mean of vertices of both, with positive weights
weights = {first}, {second}
assert all(Fraction(share) > 0 for side in weights for _, share in side)
assert all(sum(Fraction(share) for _, share in side) == 1 for side in weights)
mean = [[sum(Fraction(share) * points[k][axis] for k, share in side) for axis in range(3)]
        for side, points in zip(weights, (one, other))]
assert mean[0] == mean[1]"""

_PLANE = """# along this direction every point of the first lies farther than every point of the second
normal = [Fraction(part) for part in {normal}]
along = [[sum(n * c for n, c in zip(normal, point)) for point in points] for points in (one, other)]
assert min(along[0]) > max(along[1])"""


_PACKING = "import base64\nimport zlib\n"
_UNPACK = """def unpacked(text, kind):
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), kind).reshape(-1, 3).copy()

"""


def script_of(case: Case) -> str | None:
    """The file, if the library is one that can be asked so and this shows the error; it is run to know.

    Parameters
    ----------
    case : of two bodies
    """
    call = CALLS.get((case.wrong, case.scene.shape))  # of libraries alone: methods of this program have none
    if call is None or case.question.query != "collision" or len(case.scene.bodies) != 2:
        return None
    text = _written(case, call)
    return text if text is not None and text.count("\n") <= LONGEST and reproduces(text) else None


def reproduces(text: str) -> bool:
    """Whether a file shows the error on this machine."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "reproduction.py"
        path.write_text(text, encoding="utf-8")
        try:
            ended = subprocess.run(
                [sys.executable, str(path)], capture_output=True, timeout=_SECONDS, text=True, check=False
            )
        except subprocess.TimeoutExpired:
            return False
    return ended.returncode == 0 and ended.stdout.rstrip().endswith("\nreproduced")


def _written(case: Case, call: Call) -> str | None:
    scene = replace(case.scene, hulls={})  # what the library is given, not what it makes of it
    bodies, pose, (i, j) = scene.bodies, case.pose, case.bodies
    truth = judge(scene, i, j, pose.positions, pose.quaternions)
    if truth.touching != case.judgement.touching:
        return None
    proof = truth.certificate
    solids = [scene.solid_of_body(body) for body in (i, j)]
    if truth.touching:
        sides = [proof["first"], proof["second"]]
        if "faces" in proof:  # of two triangles: their corners are vertices of the mesh
            sides = [
                [[int(solid.faces[face][k]), share] for k, share in side]
                for solid, face, side in zip(solids, proof["faces"], sides, strict=True)
            ]
        checked = _COMMON.format(first=sides[0], second=sides[1])
    else:
        if scene.shape == "mesh":  # a plane between two triangles parts no more than these
            hulls = judge(replace(scene, shape="hull"), i, j, pose.positions, pose.quaternions)
            if hulls.touching:
                return None
            proof = hulls.certificate
        checked = _PLANE.format(normal=proof["normal"])
    unit = call.unit(bodies.sizes)
    parts = [_solid(solid, unit) for solid in solids]
    places = [(pose.positions[body] / unit).tolist() for body in (i, j)]
    turns = [pose.quaternions[body].tolist() for body in (i, j)]
    packed = any(part.startswith("unpacked") for both in parts for part in both)
    return _TEXT.format(
        packing=_PACKING if packed else "",
        unpack=_UNPACK if packed else "",
        library=call.library,
        version=call.version,
        imports=call.imports,
        ask="\n".join(f"    {line}" if line else "" for line in call.ask.strip().splitlines()) + "\n",
        shape=scene.shape,
        pose=pose.name,
        unit=unit,
        state="overlapping" if truth.touching else "separate",
        truth=f"overlap by {-truth.gap / unit:.3g}" if truth.touching else f"are {truth.gap / unit:.3g} apart",
        is_touching=truth.touching,
        proof=checked,
        first=parts[0][0],
        faces=parts[0][1],
        second=parts[1][0],
        other_faces=parts[1][1],
        position=places[0],
        quaternion=turns[0],
        other_position=places[1],
        other_quaternion=turns[1],
    )


def _solid(solid: Surface, unit: float) -> tuple[str, str]:
    """Vertices and faces as expressions."""
    vertices: Floats = solid.vertices / unit
    return _array(vertices, "<f8"), _array(solid.faces, "<i4")


def _array(rows: NDArray[Any], kind: str) -> str:
    if rows.size <= _FEW:
        return f'np.array({rows.tolist()}, "{kind}")'
    packed = base64.b85encode(zlib.compress(np.ascontiguousarray(rows, kind).tobytes(), 9)).decode("ascii")
    return f'unpacked("{packed}", "{kind}")'
