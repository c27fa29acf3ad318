"""A picture of two bodies: both cut by one plane through their centres and the place where they meet."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.compare.outcome import Case
from harness.compare.poses import Frame
from harness.compare.surfaces import turned
from harness.scene.scene import Scene

Segment = list[float]
"""Of a cut: x and y of its start, x and y of its end, m."""

_CORNERS = 64  # of the polygon that stands for a sphere


def cross_section(case: Case) -> list[list[Segment]]:
    """What a plane cuts out of both bodies of a case, each as segments in the plane.

    The first axis of the plane points from the first body to the second, whose centres lie on it at -d/2 and d/2. Of a
    frame the moment is shown that was judged.
    """
    i, j = case.bodies
    pose = case.pose.at(case.scene, case.moment) if isinstance(case.pose, Frame) else case.pose
    positions = pose.positions[[i, j]]
    across, up = _axes(case, positions)
    middle = positions.mean(axis=0)
    return [
        _cut(case.scene, body, pose.positions[body] - middle, pose.quaternions[body], across, up) for body in (i, j)
    ]


def _axes(case: Case, positions: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors of the plane: along the centres, and towards what the certificate names."""
    across = positions[1] - positions[0]
    across = across / np.linalg.norm(across) if across.any() else np.array([1.0, 0.0, 0.0])
    proof = case.judgement.certificate
    if "point" in proof:
        hint = np.array(proof["point"], np.float64) - positions[0]
    else:
        hint = np.array([float(part) for part in proof.get("normal", (0.0, 0.0, 0.0))])
    hints = [hint / (np.abs(hint).max() or 1.0), *np.eye(3)[np.argsort(np.abs(across), kind="stable")]]
    for hint in hints:
        up = hint - (hint @ across) * across
        length = float(np.linalg.norm(up))
        if length > 1e-3:
            return across, up / length
    raise AssertionError("some axis lies across")


def _cut(scene: Scene, body: int, place: Floats, quaternion: Floats, across: Floats, up: Floats) -> list[Segment]:
    size = float(scene.bodies.sizes[body])
    centre = np.array([place @ across, place @ up])
    if scene.shape == "sphere":
        angles = np.linspace(0, 2 * np.pi, _CORNERS + 1)
        corners = centre + size / 2 * np.column_stack([np.cos(angles), np.sin(angles)])
        return _rounded(np.hstack([corners[:-1], corners[1:]]), size)
    solid = scene.solid_of_body(body)
    vertices = turned(solid.vertices, quaternion) + place
    triangles = vertices[solid.faces]
    heights = triangles @ np.cross(across, up)
    # a corner in the plane counts as above it, so that a triangle is cut twice or not at all
    above = heights >= 0
    cut = above.any(axis=1) & ~above.all(axis=1)
    segments = [_crossing(t, h) for t, h in zip(triangles[cut], heights[cut], strict=True)]
    flat = np.array(segments).reshape(-1, 2, 3) @ np.column_stack([across, up])
    return _rounded(flat.reshape(-1, 4), size)


def _crossing(triangle: Floats, heights: Floats) -> list[Floats]:
    """The two points where the edges of a triangle cross height 0."""
    ends = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        if (heights[a] >= 0) != (heights[b] >= 0):
            share = heights[a] / (heights[a] - heights[b])
            ends.append(triangle[a] + share * (triangle[b] - triangle[a]))
    return ends


def _rounded(segments: Floats, size: float) -> list[Segment]:
    """To a ten-thousandth of the size: enough to draw, and the same on every machine."""
    digits = 4 - int(np.floor(np.log10(size)))
    return [[round(part, digits) for part in segment] for segment in segments.tolist()]
