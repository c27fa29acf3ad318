"""What is read of mesh files, and how: all that stands in `mesh_tables`, and polygons in every format that has them."""

import itertools
import math
import os

import numpy as np
import pytest
import trimesh

from harness.errors import InputError
from harness.scene.formats import FORMATS
from harness.scene.mesh_file import read_mesh
from harness.scene.topology import area, volume
from tests.scene.mesh_samples import CUBE, L_STRAIGHT, RING, TRIANGLES, L, Solid, U, obj, off, ply, stl_binary, stl_text
from tests.scene.mesh_tables import READ, REFUSED

POLYGONS = {
    "a.obj": obj,
    "a.ply": ply,
    "little.ply": lambda solid: ply(solid, "<"),
    "big.ply": lambda solid: ply(solid, ">", "double", "ushort", "uint"),
    "a.off": off,
    "a.stl": stl_text,
}


def facts(path):
    """Area and volume in the unit of the file, and the mesh."""
    mesh = read_mesh(path)
    enclosed = volume(mesh.vertices, mesh.faces) * mesh.diameter**3
    return float(area(mesh.vertices, mesh.faces).sum()) * mesh.diameter**2, enclosed, mesh


def written(folder, name, content):
    path = folder / name
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("name", "what", "content", "surface", "enclosed"), READ, ids=[f"{r[0]}: {r[1]}" for r in READ]
)
def test_a_file_is_read_as_it_was_meant(tmp_path, name, what, content, surface, enclosed):
    found = facts(written(tmp_path, name, content))
    assert found[:2] == pytest.approx((surface, enclosed))
    assert found[2].watertight


@pytest.mark.parametrize(("name", "what", "content", "reason"), REFUSED, ids=[f"{r[0]}: {r[1]}" for r in REFUSED])
def test_a_refusal_says_the_true_reason_and_the_line(tmp_path, name, what, content, reason):
    with pytest.raises(InputError) as caught:
        read_mesh(written(tmp_path, name, content))
    message = str(caught.value)
    assert reason in message
    assert message.startswith(f"{name}: ")
    assert message.isprintable()


@pytest.mark.parametrize(
    ("name", "content", "note"),
    [
        ("a.stl", stl_binary(TRIANGLES)[:80] + b"\6" + stl_binary(TRIANGLES)[81:], "300 bytes behind the 6 announced"),
        ("a.ply", ply(CUBE).replace(b"face 6", b"face 3"), "15 words behind the 3 announced faces"),
        ("a.ply", ply(CUBE, "<").replace(b"face 6", b"face 5"), "17 bytes behind the 5 announced faces"),
        ("a.off", off(CUBE).replace(b"8 6", b"8 1"), "5 lines behind the one announced face"),
        ("a.obj", obj(CUBE) + b"ff 1 2 3\n", 'no such line: line 15 begins with "ff"'),
    ],
)
def test_what_a_file_has_beyond_what_it_announces_is_said(tmp_path, name, content, note):
    notes = read_mesh(written(tmp_path, name, content)).notes
    assert any(note in said for said in notes), notes


def test_what_is_no_file_is_called_what_it_is(tmp_path):
    (tmp_path / "folder.obj").mkdir()
    os.mkfifo(tmp_path / "pipe.obj")
    (tmp_path / "gone.obj").symlink_to("nowhere")
    (tmp_path / "round.obj").symlink_to("round.obj")
    for name, reason in (
        ("folder", "this is a folder"),
        ("pipe", "this is a pipe or a device"),
        ("gone", "a link to a file that there is not"),
        ("round", "cannot be read: Too many levels of symbolic links"),
        ("none", "there is no such mesh file"),
    ):
        with pytest.raises(InputError, match=reason):
            read_mesh(tmp_path / f"{name}.obj")


@pytest.mark.parametrize("name", POLYGONS)
@pytest.mark.parametrize(
    "solid",
    [
        L,
        pytest.param(L_STRAIGHT, marks=pytest.mark.slow),
        pytest.param(U, marks=pytest.mark.slow),
        pytest.param(RING, marks=pytest.mark.slow),
    ],
    ids=["L", "straight corners", "U", "ring"],
)
def test_concave_polygons_keep_their_notches_wherever_they_begin(tmp_path, name, solid):
    turn = np.array([[2, 1, 2], [-2, 2, 1], [-1, -2, 2]]) / 3  # a rotation
    for start, tilted in itertools.product(range(len(solid.polygons[0])), (False, True)):
        caps = [polygon[start:] + polygon[:start] for polygon in solid.polygons]
        points = np.array(solid.vertices) @ turn if tilted else np.array(solid.vertices)
        found = facts(written(tmp_path, name, POLYGONS[name](Solid(points.tolist(), caps, *solid[2:]))))
        assert found[:2] == pytest.approx((solid.area, solid.volume))
        assert found[2].watertight
        assert found[2].notes == ()
        assert len(found[2].faces) == sum(len(polygon) - 2 for polygon in solid.polygons)


@pytest.mark.parametrize("name", POLYGONS)
def test_polygons_that_are_bent_or_cross_themselves_are_counted(tmp_path, name):
    bent = [*CUBE.vertices[:7], (0.0, 1.2, 1.3)]
    crossed = [[4, 6, 5, 7], *CUBE.polygons[1:]]
    star = [(math.cos(0.8 * math.pi * k), math.sin(0.8 * math.pi * k), z) for z in (0.0, 1.0) for k in range(5)]
    sides = [[k, (k + 1) % 5, (k + 1) % 5 + 5, k + 5] for k in range(5)]
    for vertices, polygons, note in (
        (bent, CUBE.polygons, "2 polygons are not plane"),
        (CUBE.vertices, crossed, "1 polygon crosses itself"),
        (star, [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], *sides], "2 polygons cross themselves"),
    ):
        notes = read_mesh(written(tmp_path, name, POLYGONS[name](Solid(vertices, polygons, 0, 0)))).notes
        assert any(note in said for said in notes)


def test_degenerate_faces_are_left_out_and_counted(tmp_path):
    middle = obj(CUBE) + b"v 0.5 0 0\nf 1 2 9\nf 1 1 2\nf 3 3 3\n"
    mesh = read_mesh(written(tmp_path, "a.obj", middle))
    assert mesh.digest == read_mesh(written(tmp_path, "b.obj", obj(CUBE))).digest
    assert mesh.notes == ("3 degenerate faces without area left out",)
    assert mesh.convex


def test_a_seam_closed_by_a_face_without_area_is_no_gap(tmp_path):
    split = obj(CUBE).replace(b"f 1 2 6 5\n", b"f 1 9 6 5\nf 9 2 6\nf 1 2 9\n") + b"v 0.5 0 0\n"
    mesh = read_mesh(written(tmp_path, "a.obj", split))
    assert len(mesh.faces) == 13
    assert mesh.watertight
    assert mesh.convex


@pytest.mark.parametrize(("form", "unusual"), [("obj", b" #\n"), ("off", b" #\n"), ("stl_ascii", b"\n#\n")])
def test_lines_read_one_by_one_give_what_blocks_of_lines_give(form, unusual):
    content = trimesh.creation.icosphere(3).export(file_type=form).encode()
    read = FORMATS[form[:3]]
    fast, slow = read(content), read(content.replace(b"\n", unusual))
    assert np.array_equal(fast.vertices, slow.vertices)
    assert np.array_equal(fast.corners, slow.corners)
    assert np.array_equal(fast.lengths, slow.lengths)


@pytest.mark.parametrize("form", ["obj", "off"])
def test_a_fault_within_many_lines_is_found_at_its_line(form, tmp_path):
    lines = trimesh.creation.icosphere(3).export(file_type=form).encode().splitlines()
    for number in (100, 500, 1500):
        wrong = list(lines)
        wrong[number - 1] = wrong[number - 1].rpartition(b" ")[0] + b" x7"
        with pytest.raises(InputError, match=f'line {number}: "x7" is not'):
            read_mesh(written(tmp_path, f"a.{form}", b"\n".join(wrong)))
