"""Still pictures kept between reports: to draw one takes longer than to write the page around it."""

from __future__ import annotations

import hashlib
import json

from harness.installed import installed
from harness.kept_files import keep, kept
from harness.replay.document import start_positions, view_box
from harness.store.recording import Recording

WIDTH, HEIGHT = 800, 500
KIND = "stills"
_SIGN = hashlib.sha256().digest_size


def still_of(recording: Recording) -> bytes:
    """The still of a recording, a PNG of `WIDTH` × `HEIGHT` px, drawn where it is not kept."""
    name = f"{_content(recording)}.png"
    signed = kept(KIND, name) or b""
    sign, picture = signed[:_SIGN], signed[_SIGN:]
    if hashlib.sha256(picture).digest() != sign:
        from harness.replay.still import still  # of libraries for images, which a report can do without else

        picture = still(recording)
        keep(KIND, name, hashlib.sha256(picture).digest() + picture)
    return picture


def _content(recording: Recording) -> str:
    """A hash of all that its first moment is drawn from, and of what draws it."""
    middle, half = view_box(recording)
    boxed = recording.half_box is not None
    facts = [installed(), boxed, recording.shape, len(recording), [surface.digest for surface in recording.surfaces]]
    content = hashlib.sha256(json.dumps(facts).encode())
    placed = start_positions(recording), recording.quaternions, recording.sizes, recording.surface_of
    for array in (middle, half, *placed):
        content.update(array.tobytes())
    return content.hexdigest()[:40]
