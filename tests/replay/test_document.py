"""What the viewer reads says what was recorded, within the stated error, and is the same each time."""

import base64
import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from harness.replay.document import document
from harness.replay.kept_still import still_of
from harness.replay.page import replay_page
from harness.replay.still import still
from harness.store.recording import NearLines
from tests.store.test_recording import SQUARE, TRIANGLE, recording

KINDS = {"f4": "<f4", "f8": "<f8", "i4": "<i4", "u4": "<u4", "u2": "<u2"}


def arrays(found):
    content = base64.b64decode(found["data"])
    return {
        name: np.frombuffer(content, KINDS[kind], length, offset)
        for name, (kind, offset, length) in found["arrays"].items()
    }


def test_legs_are_sorted_by_body_and_rounded_to_32_bits():
    recorded = recording()
    found = arrays(document(recorded, "X"))
    assert found["leg_starts"].tolist() == [0, 2, 4, 6]
    for body in range(3):
        mine = recorded.leg_bodies == body
        legs = slice(*found["leg_starts"][body : body + 2])
        assert (found["leg_times"][legs] == recorded.leg_times[mine]).all()
        places = found["leg_positions"].reshape(-1, 3)[legs]
        assert np.abs(places - recorded.leg_positions[mine]).max() <= 2.0**-24


def test_hits_name_bodies_and_walls():
    found = arrays(document(recording(), "X"))
    assert found["hit_times"].tolist() == [0.7, 0.9]
    assert found["hit_first"].tolist() == [0, 1]
    assert found["hit_second"].tolist() == [2, -1 - 3]


def test_lines_and_rings_are_there_where_a_query_has_them():
    assert not {"near_frames", "hit_points"} & arrays(document(recording(), "X")).keys()
    near = NearLines(np.array([1, 3]), np.array([[0, 1], [0, 2]]), np.arange(12.0).reshape(2, 2, 3))
    made = replace(recording(), near=near, hit_points=np.array([[0.5, 0, 0], [np.nan] * 3]))
    found = arrays(document(made, "X"))
    assert found["near_frames"].tolist() == [1, 3]
    assert (found["near_first"].tolist(), found["near_second"].tolist()) == ([0, 0], [1, 2])
    assert found["near_points"].tolist() == list(range(12))
    assert found["hit_points"][:3].tolist() == [0.5, 0, 0]
    assert "two bodies come near each other 1 time, and 1 hits at walls" in replay_page(made, "X")


def test_a_large_mesh_has_wide_corner_numbers():
    recorded = recording()
    vertices = np.zeros((2**16, 3))
    large = recorded.surfaces[0]._replace(vertices=vertices)
    object.__setattr__(recorded, "surfaces", (large,))
    assert document(recorded, "X")["arrays"]["faces"][0] == "u4"


def test_a_mixture_carries_every_mesh_once_and_says_which_body_has_which():
    mixed = recording((TRIANGLE, SQUARE))
    found = document(mixed, "X")
    told = arrays(found)
    assert told["mesh_of"].tolist() == [0, 1, 0]
    assert (told["vertex_starts"].tolist(), told["face_starts"].tolist()) == ([0, 3, 7], [0, 1, 3])
    assert told["faces"].tolist() == [0, 1, 2, 0, 1, 2, 0, 2, 3]
    assert found["mesh"] == "triangle, square"


def test_the_page_is_one_file_that_asks_for_nothing_and_the_same_each_time():
    page = replay_page(recording(), "</script><script>alert(1)</script>", [("mesh", "<b>")])
    assert page == replay_page(recording(), "</script><script>alert(1)</script>", [("mesh", "<b>")])
    assert page.count("</script>") == 2
    assert "<b>" not in page
    assert not re.search(r"""https?://|@import|url\(|src="(?!data:)|^(import|export)\b""", page, re.MULTILINE)
    carried = re.search(r'<script type="application/json" id="recording">(.*?)</script>', page, re.DOTALL).group(1)
    assert json.loads(carried)["title"] == "</script><script>alert(1)</script>"


@pytest.mark.parametrize("surface", [(), recording().surfaces])
def test_the_still_shows_the_box_and_the_bodies_on_nothing(surface):
    picture = Image.open(io.BytesIO(still(recording(surface)))).convert("RGBA")
    opaque = np.asarray(picture)[..., 3] > 0
    assert 0.005 < opaque.mean() < 0.6
    assert not opaque[0].any()
    assert not opaque[:, 0].any()


def test_a_still_is_drawn_once_and_a_damaged_one_again(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first = still_of(recording())
    assert first == still(recording())
    (file,) = (tmp_path / "harness" / "stills").iterdir()
    with monkeypatch.context() as changed:
        changed.setattr("harness.replay.still.still", lambda _: b"drawn again")
        assert still_of(recording()) == first
        assert still_of(recording(())) == b"drawn again"  # spheres in place of meshes
        moved = replace(recording(), leg_positions=recording().leg_positions + 0.25)
        assert still_of(moved) == b"drawn again"
    file.write_bytes(file.read_bytes()[:-1])
    assert still_of(recording()) == first
