"""A wrong answer as a Python file that needs numpy and the library alone, for those who maintain the library.

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
from math import isinf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.compare.certificate import Judgement
from harness.compare.exact_gap import ExactGap
from harness.compare.impact_calls import IMPACT_CALLS
from harness.compare.judge import judge
from harness.compare.library_calls import CALLS, GAP_CALLS, Call
from harness.compare.outcome import Case
from harness.compare.poses import Frame, Pose
from harness.scene.mesh import Surface
from harness.scene.scene import Scene

LONGEST, LONGEST_OF_MOTION = 60, 80
"""Lines, of a file about bodies at rest and about moving ones."""
_SECONDS = 60.0
# Numbers that are written out; more of them are packed.
_FEW = 48

_TEXT = '''"""{library}: {error} ({pose}). Needs numpy and {library} alone."""

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
{motion}

def {question}():
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


{placed}
{proof}
said = {question}()
print("{library}", {version}, "says", {said})
print("exactly, they {truth}, which is checked")
print("reproduced" if {wrong} else "not reproduced: this version answers otherwise")
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

# of gaps, against a limit between what is true and what was told
_POINTS = """# two points, means of vertices of either with positive weights, are nearer than this
limit = Fraction({limit!r})
weights = {first}, {second}
assert all(Fraction(share) > 0 for side in weights for _, share in side)
assert all(sum(Fraction(share) for _, share in side) == 1 for side in weights)
mean = [[sum(Fraction(share) * points[k][axis] for k, share in side) for axis in range(3)]
        for side, points in zip(weights, (one, other))]
assert sum((a - b) ** 2 for a, b in zip(*mean)) < limit ** 2"""
_FAR_PLANE = (
    "# and the hulls are farther apart than this\nlimit = Fraction({limit!r})\n"
    + _PLANE
    + """
assert (min(along[0]) - max(along[1])) ** 2 > limit ** 2 * sum(n * n for n in normal)"""
)


# of times: where the two are at a moment, and how they came there
_MOTION = """V, W, X, Y = {velocity}, {spin}, {other_velocity}, {other_spin}  # velocities and spins
DURATION, T = {duration}, {moment}  # of the motion, and a moment
AT = [{at}, {turned}], [{other_at}, {other_turned}]  # then


def times(p, q):
    vector = np.multiply(p[0], q[1:]) + np.multiply(q[0], p[1:]) + np.cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - np.dot(p[1:], q[1:]), *vector])


def moved(place, turn, velocity, spin, t):
    turned = np.sinc(np.linalg.norm(spin) * t / 2 / np.pi) * t / 2 * np.array(spin)
    return place + t * np.array(velocity), times([np.cos(np.linalg.norm(spin) * t / 2), *turned], turn)

"""
_STILL = "one, other = exact(A, P, Q), exact(B, R, S)"
_MOVED = """for told, now in zip(AT, (moved(P, Q, V, W, T), moved(R, S, X, Y, T))):
    assert all(np.allclose(a, b, rtol=0, atol=1e-13 * (1 + np.abs(b).max())) for a, b in zip(told, now))
one, other = exact(A, *AT[0]), exact(B, *AT[1])"""


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
    calls, written = {
        "collision": (CALLS, _written),
        "tolerance": (GAP_CALLS, _written_of_gap),
        "distance": (GAP_CALLS, _written_of_gap),
        "impact": (IMPACT_CALLS, _written_of_impact),
    }[case.question.query]
    call = calls.get((case.wrong, case.scene.shape))  # of libraries alone: methods of this program have none
    if call is None or len(case.scene.bodies) != 2:
        return None
    text, longest = written(case, call), LONGEST_OF_MOTION if case.question.query == "impact" else LONGEST
    return text if text is not None and text.count("\n") <= longest and reproduces(text) else None


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
    truth, proof = _proved(scene, case.pose, case.bodies)
    if proof is None or truth.touching != case.judgement.touching:
        return None
    state = "overlapping" if truth.touching else "separate"
    unit = call.unit(scene.bodies.sizes)
    return _filled(
        scene,
        case,
        call,
        error=f"{state} {scene.shape}s of which it says the opposite",
        question="touching",
        proof=proof,
        said='"they touch" if said else "they do not touch"',
        truth=f"overlap by {-truth.gap / unit:.3g}" if truth.touching else f"are {truth.gap / unit:.3g} apart",
        wrong=f"said != {truth.touching}",
    )


def _proved(scene: Scene, pose: Pose, pair: tuple[int, int]) -> tuple[Judgement, str | None]:
    """Whether two bodies touch, and lines that prove it, where one common point or one plane does."""
    truth = judge(scene, *pair, pose.positions, pose.quaternions)
    proof = truth.certificate
    if not truth.touching:
        if scene.shape == "mesh":  # a plane between two triangles parts no more than these
            hulls = judge(replace(scene, shape="hull"), *pair, pose.positions, pose.quaternions)
            if hulls.touching:
                return truth, None
            proof = hulls.certificate
        return truth, _PLANE.format(normal=proof["normal"])
    sides = [proof["first"], proof["second"]]
    if "faces" in proof:  # of two triangles: their corners are vertices of the mesh
        solids = [scene.solid_of_body(body) for body in pair]
        sides = [
            [[int(solid.faces[face][k]), share] for k, share in side]
            for solid, face, side in zip(solids, proof["faces"], sides, strict=True)
        ]
    return truth, _COMMON.format(first=sides[0], second=sides[1])


def _written_of_gap(case: Case, call: Call) -> str | None:
    """Of a gap that is too wide or too narrow, or of a near pair that is missed or one that is told and is not near."""
    scene, told = replace(case.scene, hulls={}), case.told
    unit = call.unit(scene.bodies.sizes)
    exact = ExactGap(scene, case.pose, case.bodies)
    if told is None or scene.shape == "sphere":
        return None
    other = told if case.question.query == "distance" and not isinf(told) else case.question.within
    limit = 0.5 * (exact.value + other) / unit
    too_wide = isinf(told) or told > exact.value
    if too_wide:
        proof = _POINTS.format(limit=limit, first=exact.certificate["first"], second=exact.certificate["second"])
    else:
        hulls = judge(replace(scene, shape="hull"), *case.bodies, case.pose.positions, case.pose.quaternions)
        if hulls.touching:  # what parts two surfaces in each other's hollows is more than one plane
            return None
        proof = _FAR_PLANE.format(limit=limit, normal=hulls.certificate["normal"])
    return _filled(
        scene,
        case,
        call,
        error=f"two {scene.shape}s, of which it tells too {'wide' if too_wide else 'narrow'} a gap",
        question="gap",
        proof=proof,
        said='"that the gap is", said',
        truth=f"are {exact.value / unit:.6g} apart",
        wrong="said > limit" if too_wide else "said < limit",
    )


def _written_of_impact(case: Case, call: Call) -> str | None:
    """Of a time at which the two are still apart, or of none before they are in each other."""
    frame, scene, moment = case.pose, replace(case.scene, hulls={}), case.moment
    if not isinstance(frame, Frame) or scene.shape == "sphere":
        return None
    i, j = sorted(case.bodies, key=lambda body: float(np.linalg.norm(frame.spins[body])))
    there = frame.at(scene, moment)
    straight = frame.positions + moment * frame.velocities
    if not np.allclose(there.positions, straight, rtol=0.0, atol=1e-12 * np.abs(straight).max()):
        return None  # a wall has turned one
    truth, proof = _proved(scene, there, (i, j))
    if proof is None or truth.touching != case.judgement.touching:
        return None
    unit = call.unit(scene.bodies.sizes)
    motion = _MOTION.format(
        velocity=(frame.velocities[i] / unit).tolist(),
        spin=frame.spins[i].tolist(),
        duration=frame.duration,
        other_velocity=(frame.velocities[j] / unit).tolist(),
        other_spin=frame.spins[j].tolist(),
        moment=moment,
        at=(there.positions[i] / unit).tolist(),
        turned=there.quaternions[i].tolist(),
        other_at=(there.positions[j] / unit).tolist(),
        other_turned=there.quaternions[j].tolist(),
    )
    state = "overlap" if truth.touching else "are apart"
    return _filled(
        scene,
        replace(case, bodies=(i, j)),
        call,
        error=f"two {scene.shape}s, of which it tells too {'late' if truth.touching else 'early'} when they meet",
        question="first_touch",
        motion=motion,
        placed=_MOVED,
        proof=proof,
        said='"never" if said is None else f"at {said:.9g} s"',
        truth=f"{state} by {abs(truth.gap) / unit:.3g} at {moment:.9g} s",
        wrong="said is None or said > T" if truth.touching else "said is not None and abs(said - T) <= 1e-6 * DURATION",
    )


def _filled(scene: Scene, case: Case, call: Call, motion: str = "", placed: str = _STILL, **texts: str) -> str:
    """The file, given what is asked and proved, and how the bodies move where they do."""
    pose, unit = case.pose, call.unit(scene.bodies.sizes)
    (first, faces), (second, other_faces) = (_solid(scene.solid_of_body(body), unit) for body in case.bodies)
    position, other_position = ((pose.positions[body] / unit).tolist() for body in case.bodies)
    quaternion, other_quaternion = (pose.quaternions[body].tolist() for body in case.bodies)
    packed = any(part.startswith("unpacked") for part in (first, faces, second, other_faces))
    return _TEXT.format(
        packing=_PACKING if packed else "",
        unpack=_UNPACK if packed else "",
        library=call.library,
        version=call.version,
        imports=call.imports,
        ask="\n".join(f"    {line}" if line else "" for line in call.ask.strip().splitlines()) + "\n",
        pose=pose.name,
        unit=unit,
        first=first,
        faces=faces,
        second=second,
        other_faces=other_faces,
        position=position,
        quaternion=quaternion,
        other_position=other_position,
        other_quaternion=other_quaternion,
        motion=motion,
        placed=placed,
        **texts,
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
