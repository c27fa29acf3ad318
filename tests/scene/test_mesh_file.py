from pathlib import Path

import numpy as np
import pytest
import trimesh

from harness.errors import InputError
from harness.scene.mesh_file import make_mesh, read_mesh
from harness.scene.ply_file import write_ply

CUBE = trimesh.creation.box()


@pytest.fixture
def shipped():
    """The folder of meshes that pybullet brings, on Pythons where it has wheels."""
    reason = "pip install 'harness[pybullet]'"
    return Path(pytest.importorskip("pybullet_data", reason=reason).getDataPath())


def refused(path):
    with pytest.raises(InputError) as caught:
        read_mesh(path)
    return str(caught.value)


@pytest.mark.parametrize(
    ("name", "faces", "vertices"),
    [
        ("duck.obj", 4212, 2108),
        pytest.param("soccerball.obj", 9048, 4526, marks=pytest.mark.slow),
        ("bunny.obj", 902, 453),
        ("sphere_smooth.obj", 1792, 898),
        pytest.param("differential/diff_spider.stl", 11840, 5920, marks=pytest.mark.slow),
    ],
)
def test_real_meshes_keep_their_faces_and_close_once_equal_vertices_are_one(shipped, name, faces, vertices):
    mesh = read_mesh(shipped / name)
    assert (len(mesh.faces), len(mesh.vertices)) == (faces, vertices)
    assert mesh.watertight
    # the ball's squares are bent
    assert mesh.notes == () or (name == "soccerball.obj" and "polygons are not plane" in mesh.notes[0])
    assert np.linalg.norm(mesh.vertices, axis=1).max() == pytest.approx(0.5, rel=1e-14)


def test_several_pieces_are_allowed_and_said(shipped):
    assert read_mesh(shipped / "teddy2_VHACD_CHs.obj").notes == ("in 15 pieces that share no vertex",)


@pytest.mark.parametrize("form", ["ply", "obj", "stl", "off", "glb"])
def test_every_format_gives_the_same_surface(tmp_path, form):
    path = tmp_path / f"cube.{form}"
    (CUBE.apply_translation([3, 4, 5])).export(path)
    mesh = read_mesh(path)
    assert (len(mesh.vertices), len(mesh.faces), len(mesh.hull.vertices)) == (8, 12, 8)
    assert mesh.watertight
    assert mesh.convex
    assert mesh.diameter == pytest.approx(np.sqrt(3))
    np.testing.assert_allclose(np.abs(mesh.vertices), 0.5 / np.sqrt(3), atol=1e-15)


def test_written_in_double_precision_a_mesh_comes_back_to_the_bit(shipped, tmp_path):
    mesh = read_mesh(shipped / "bunny.obj")
    write_ply(tmp_path / "bunny.ply", mesh.vertices, mesh.faces)
    again = read_mesh(tmp_path / "bunny.ply")
    assert np.array_equal(again.faces, mesh.faces)
    np.testing.assert_allclose(again.vertices, mesh.vertices, atol=1e-16)


def test_the_digest_tells_surfaces_apart_and_not_files(tmp_path):
    for name in ("one.ply", "two.off"):
        CUBE.export(tmp_path / name)
    one, two = read_mesh(tmp_path / "one.ply"), read_mesh(tmp_path / "two.off")
    assert one.digest == two.digest
    assert one.digest != make_mesh("open", CUBE.vertices, CUBE.faces[:-1]).digest


def test_vertices_no_face_uses_have_no_part_in_the_bounding_sphere():
    mesh = make_mesh("cube", np.vstack([CUBE.vertices, [[np.nan] * 3, [1e9] * 3]]), CUBE.faces)
    assert (len(mesh.vertices), len(mesh.hull.vertices)) == (8, 8)
    assert mesh.convex


def test_what_is_odd_but_allowed_is_noted():
    faces = np.asarray(CUBE.faces)
    degenerate = np.vstack([faces, [[0, 0, 1]]])
    fin = np.vstack([faces, [[faces[0, 0], faces[0, 1], 8]]])
    turned = np.vstack([faces[:1, ::-1], faces[1:]])
    above = np.vstack([CUBE.vertices, CUBE.vertices.mean(axis=0)])
    assert make_mesh("", CUBE.vertices, faces[1:]).notes == ("open: 3 boundary edges",)
    assert make_mesh("", CUBE.vertices, degenerate).notes == ("1 degenerate face without area left out",)
    assert "non-manifold: 1 edge of more than two faces" in make_mesh("", above, fin).notes
    assert make_mesh("", CUBE.vertices, turned).notes[0].startswith("inconsistent: faces on the two sides of 3 edges")


def test_convex_means_that_the_hull_may_stand_for_the_mesh():
    ball, ring = trimesh.creation.icosphere(3), trimesh.creation.torus(1, 0.3)
    dented = np.array(ball.vertices)
    dented[0] *= 0.95
    inside_out = ball.faces[:, ::-1]
    finely = CUBE.subdivide().subdivide()
    two = trimesh.util.concatenate([ball, ball.copy().apply_scale(0.5)])
    for vertices, faces, convex in (
        (ball.vertices, ball.faces, True),
        (ball.vertices, inside_out, True),
        (finely.vertices, finely.faces, True),
        (ball.vertices, ball.faces[1:], False),
        (dented, ball.faces, False),
        (ring.vertices, ring.faces, False),
        (two.vertices, two.faces, False),
    ):
        assert make_mesh("", vertices, faces).convex == convex


def test_arrays_are_contiguous_and_cannot_be_written():
    mesh = make_mesh("", CUBE.vertices, CUBE.faces)
    for array, kind in ((mesh.vertices, np.float64), (mesh.faces, np.int32), (mesh.hull.faces, np.int32)):
        assert array.dtype == kind
        assert array.flags.c_contiguous
        assert not array.flags.writeable


def test_what_is_no_solid_surface_is_refused_with_the_reason(tmp_path):
    for vertices, faces, reason in (
        (CUBE.vertices, np.empty((0, 3), int), "empty"),
        (CUBE.vertices, [[0, 1, 99]], "1 of the mesh's faces name a vertex that does not exist"),
        (CUBE.vertices, [[0, 1, -1]], "does not exist"),
        (CUBE.vertices * [1, 1, np.inf], CUBE.faces, "8 of the mesh's vertices are not finite"),
        (CUBE.vertices, [[0, 0, 1], [2, 2, 3], [4, 4, 5], [6, 6, 7]], "degenerate"),
        (CUBE.vertices * 1e200, CUBE.faces, "extent"),
        (CUBE.vertices * 1e-200, CUBE.faces, "extent"),
    ):
        with pytest.raises(InputError, match=reason):
            make_mesh("", np.asarray(vertices), np.asarray(faces))


def test_what_is_no_mesh_file_is_refused_in_one_line(tmp_path):
    (tmp_path / "words.obj").write_text("once upon a time\n")
    (tmp_path / "cut.ply").write_bytes(CUBE.export(file_type="ply")[:200])
    (tmp_path / "cloud.ply").write_bytes(trimesh.PointCloud(CUBE.vertices).export(file_type="ply"))
    (tmp_path / "nothing.stl").write_bytes(b"")
    (tmp_path / "vast.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 99999999999\nelement face 1\nend_header\n"
    )
    (tmp_path / "vast.off").write_text("OFF\n8 99999999999 0\n")
    (tmp_path / "vast.stl").write_bytes(b"\0" * 80 + b"\xff" * 4)
    (tmp_path / "folder.obj").mkdir()
    (tmp_path / "page.html").write_text("<p>")
    for name in ("vast.ply", "vast.off", "vast.stl"):
        assert "announces" in refused(tmp_path / name)
    for path in [*tmp_path.iterdir(), tmp_path / "none.ply"]:
        message = refused(path)
        assert message.startswith(f"{path.name}: ")
        assert "\n" not in message


def test_a_comment_in_another_encoding_is_no_fault(tmp_path):
    text = "# Kürbis\n" + CUBE.export(file_type="obj")
    (tmp_path / "latin.obj").write_bytes(text.encode("latin-1"))
    assert len(read_mesh(tmp_path / "latin.obj").faces) == 12


def test_a_file_cannot_name_another_one(tmp_path):
    secret = tmp_path / "secret.mtl"
    secret.write_text("newmtl a\nmap_Kd /etc/hostname\n")
    (tmp_path / "mesh.obj").write_text("mtllib secret.mtl\nusemtl a\n" + CUBE.export(file_type="obj"))
    secret.chmod(0)
    assert len(read_mesh(tmp_path / "mesh.obj").faces) == 12
