"""A still picture of a recording's first moment, for pages without WebGL or without a script.

Triangles are painted from the farthest to the nearest, lit by one light, at twice the size and then scaled down.
"""

from __future__ import annotations

import io
from itertools import combinations
from typing import Any

import numpy as np
from fast_simplification import simplify
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from harness.arrays import Floats
from harness.replay.document import start_positions, view_box
from harness.replay.kept_still import HEIGHT, WIDTH
from harness.store.recording import RecordedMesh, Recording

_OVERSAMPLING = 2  # painted at so many times the size
_MOST_TRIANGLES = 24_000
_TURN, _TILT, _FIELD = 0.62, 0.42, 0.62  # as the viewer's first view, rad
_BODY, _EDGE = np.array([224.0, 148.0, 26.0]), (141, 147, 161, 255)
_COLOURS = 96
# Of a box, as the viewer numbers them: corner a and corner a | bit have an edge between them.
_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def still(recording: Recording) -> bytes:
    """A PNG with a transparent background, the same bytes for the same recording."""
    # of colours times their opacity, as their means need to be: what is painted is opaque, and the rest is all 0
    image = Image.new("RGBa", (WIDTH * _OVERSAMPLING, HEIGHT * _OVERSAMPLING), (0, 0, 0, 0))
    draw = ImageDraw.Draw(image)
    middle, half = view_box(recording)
    eye, axes = _camera(half)
    if recording.half_box is not None:
        _draw_box(draw, half, eye, axes)
    eye = eye + middle
    if len(recording):
        _draw_bodies(draw, recording, eye, axes)
    buffer = io.BytesIO()
    small = image.reduce(_OVERSAMPLING).convert("RGBA")
    # at the usual level of compression: three more bytes in a hundred than at the highest, for a third of its time
    small.quantize(_COLOURS, method=Image.Quantize.FASTOCTREE).save(buffer, format="PNG")
    return buffer.getvalue()


def _camera(half: Floats) -> tuple[Floats, Floats]:
    """Where it stands, m, and its axes: right, up, back."""
    back = np.array([np.cos(_TILT) * np.sin(_TURN), -np.cos(_TILT) * np.cos(_TURN), np.sin(_TILT)])
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(back, right), back])
    distance = 0.93 * float(np.linalg.norm(half)) / np.sin(_FIELD / 2)
    corners = (_CORNERS * half) @ axes.T
    aside = corners[:, :2] / (distance - corners[:, 2:]) * distance
    middle = (aside.min(axis=0) + aside.max(axis=0)) / 2  # of the picture of the box, which perspective puts off centre
    return back * distance + middle @ axes[:2], axes


def _projected(points: Floats, eye: Floats, axes: Floats) -> tuple[Floats, Floats]:
    """(…, 2) px and (…) depths, m, of (…, 3) points, m."""
    seen = (points - eye) @ axes.T
    depth = -seen[..., 2]
    scale = HEIGHT * _OVERSAMPLING / 2 / np.tan(_FIELD / 2)
    flat = np.stack([seen[..., 0], -seen[..., 1]], axis=-1) / depth[..., None] * scale
    return flat + np.array([WIDTH, HEIGHT]) * _OVERSAMPLING / 2, depth


def _draw_box(draw: ImageDraw.ImageDraw, half: Floats, eye: Floats, axes: Floats) -> None:
    corners = _CORNERS * half
    flat, _ = _projected(corners, eye, axes)
    for a in range(8):
        for bit in (1, 2, 4):
            if not a & bit:
                draw.line([tuple(flat[a]), tuple(flat[a | bit])], fill=_EDGE, width=_OVERSAMPLING)


def _draw_bodies(draw: ImageDraw.ImageDraw, recording: Recording, eye: Floats, axes: Floats) -> None:
    corners = _corners(recording)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    facing = ((eye - corners[:, 0]) * normals).sum(axis=1) > 0.0
    corners, normals = corners[facing], normals[facing]
    light_direction = np.array([-0.75, 1.0, 0.9]) @ axes
    light = (
        0.38
        + 0.14 * (normals @ axes[1])
        + 0.62 * np.maximum(normals @ (light_direction / np.linalg.norm(light_direction)), 0.0)
    )
    flat, depth = _projected(corners, eye, axes)
    order = np.argsort(-depth.mean(axis=1), kind="stable")
    colours = np.clip(_BODY * light[:, None], 0, 255).astype(np.int64) @ [1, 2**8, 2**16] + 255 * 2**24
    for triangle, colour in zip(flat[order].reshape(-1, 6).tolist(), colours[order].tolist(), strict=True):
        draw.polygon(triangle, fill=colour)


def _corners(recording: Recording) -> Floats:
    """(k, 3, 3) m: the triangles of all bodies."""
    turns = _turns(recording.quaternions)
    places, found = start_positions(recording), []
    for number in range(max(1, len(recording.surfaces))):
        vertices, faces = _form(recording, recording.surfaces[number] if recording.surfaces else None)
        chosen = np.flatnonzero(recording.surface_of == number) if recording.surfaces else np.arange(len(recording))
        placed = np.einsum("nij,vj->nvi", turns[chosen], vertices) * recording.sizes[chosen, None, None]
        found.append((placed + places[chosen, None, :])[:, faces].reshape(-1, 3, 3))
    return np.concatenate(found)


def _form(recording: Recording, surface: RecordedMesh | None) -> tuple[Floats, NDArray[Any]]:
    """Vertices and faces of one body of diameter 1, so coarse that all bodies together can be painted."""
    most = max(20, _MOST_TRIANGLES // len(recording))
    if surface is None:
        halvings = max(1, min(3, int(np.log(most / 20) / np.log(4))))
        return _ball(halvings)
    vertices, faces = surface.vertices, surface.faces
    if len(faces) <= most:
        return vertices, faces
    coarse, corners = simplify(vertices.copy(), faces.copy(), target_count=max(most, 60))  # it wants to write
    return np.asarray(coarse, np.float64), np.asarray(corners)


def _turns(quaternions: Floats) -> Floats:
    """(n, 3, 3), of quaternions w x y z; scipy's take a quarter of a second to import."""
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _ball(halvings: int) -> tuple[Floats, NDArray[Any]]:
    """A sphere of diameter 1: an icosahedron whose sides are halved again and again, all corners on the sphere."""
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    one, other = np.array([(a, b) for a in (-1.0, 1.0) for b in (-golden, golden)]).T
    corners = np.concatenate([np.roll(np.column_stack([np.zeros(4), one, other]), k, axis=1) for k in range(3)])
    apart = np.linalg.norm(corners[:, None] - corners, axis=2)
    joined = (apart > 1.0) & (apart < 2.5)  # the sides are 2 long
    faces = np.array(
        [
            (a, b, c) if np.linalg.det(corners[[a, b, c]]) > 0.0 else (a, c, b)
            for a, b, c in combinations(range(12), 3)
            if joined[a, b] and joined[b, c] and joined[a, c]
        ]
    )
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    for _ in range(halvings):
        sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
        unique, middles = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
        (a, b, c), (ab, bc, ca) = faces.T, middles.reshape(-1, 3).T + len(corners)
        corners = np.concatenate([corners, corners[unique].mean(axis=1)])
        corners /= np.linalg.norm(corners, axis=1, keepdims=True)
        faces = np.column_stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca]).reshape(-1, 3)
    return 0.5 * corners, faces
