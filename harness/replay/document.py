"""A recording as the viewer reads it: JSON with one base64 text that holds all arrays.

Times stay doubles. Positions, velocities, orientations and spins are rounded to 32 bits: a body is shown within
2^-23 of the distance that it has from the middle and has flown since its last hit, and turned wrong by at most 2^-24 of
the angle that it has turned in all. Legs are sorted by body, so that a viewer finds the one of any time by bisection.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.arrays import Floats, Ints
from harness.store.recording import Recording

Fact = tuple[str, str]


def document(recording: Recording, title: str, facts: Sequence[Fact] = ()) -> dict[str, Any]:
    """What the viewer needs, ready to be JSON.

    Parameters
    ----------
    recording : Recording
    title : of the page
    facts : names and values to stand beside the scene
    """
    order = np.lexsort((np.arange(len(recording.leg_times)), recording.leg_bodies))
    starts = np.searchsorted(recording.leg_bodies[order], np.arange(len(recording) + 1))
    walls = np.where(recording.hit_walls >= 0, -1 - recording.hit_walls, recording.hit_bodies[:, 1])
    arrays: dict[str, tuple[str, Any]] = {
        "leg_times": ("f8", recording.leg_times[order]),
        "hit_times": ("f8", recording.hit_times),
        "leg_starts": ("u4", starts),
        "leg_positions": ("f4", recording.leg_positions[order]),
        "leg_velocities": ("f4", recording.leg_velocities[order]),
        "sizes": ("f4", recording.sizes),
        "quaternions": ("f4", recording.quaternions),
        "spins": ("f4", recording.spins if recording.surfaces else np.zeros_like(recording.spins)),
        "hit_first": ("i4", recording.hit_bodies[:, 0]),
        "hit_second": ("i4", walls),
    }
    if recording.surfaces:
        few = max(len(surface.vertices) for surface in recording.surfaces) < 2**16
        arrays["vertices"] = ("f4", np.concatenate([surface.vertices for surface in recording.surfaces]))
        arrays["faces"] = ("u2" if few else "u4", np.concatenate([surface.faces for surface in recording.surfaces]))
        arrays["vertex_starts"] = ("u4", _starts([len(surface.vertices) for surface in recording.surfaces]))
        arrays["face_starts"] = ("u4", _starts([len(surface.faces) for surface in recording.surfaces]))
        arrays["mesh_of"] = ("u4", recording.surface_of)
    near = recording.near
    if near is not None:
        arrays["near_frames"] = ("u4", near.frames)
        arrays["near_first"], arrays["near_second"] = (("i4", near.pairs[:, side]) for side in (0, 1))
        arrays["near_points"] = ("f4", near.points)
    if recording.hit_points is not None:
        arrays["hit_points"] = ("f4", recording.hit_points)
    places: dict[str, tuple[str, int, int]] = {}
    content = bytearray()
    for name, (kind, values) in arrays.items():
        content += bytes(-len(content) % 8)  # every array begins where its numbers may
        places[name] = (kind, len(content), int(values.size))
        content += np.ascontiguousarray(values, f"<{kind}").tobytes()
    return {
        "title": title,
        "shape": recording.shape,
        "mesh": ", ".join(surface.name for surface in recording.surfaces) or None,
        "duration": recording.duration,
        "dt": recording.dt,
        "half_box": recording.half_box.tolist(),
        "facts": [list(fact) for fact in facts],
        "arrays": places,
        "data": base64.b64encode(bytes(content)).decode("ascii"),
    }


def _starts(lengths: Sequence[int]) -> Ints:
    """Where each of several arrays of these lengths begins that stand one after another, and where the last ends."""
    starts: Ints = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
    return starts


def start_positions(recording: Recording) -> Floats:
    """(n, 3) m, where the bodies are at time 0."""
    return recording.leg_positions[: len(recording)]
