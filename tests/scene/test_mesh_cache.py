"""A mesh that was read once is found again by the content of its file, and by nothing less."""

import numpy as np
import pytest
import trimesh

from harness.scene import mesh_child
from harness.scene.mesh_cache import KIND, key_of
from harness.scene.mesh_child import open_meshes


@pytest.fixture
def cube(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    path = tmp_path / "cube.ply"
    trimesh.creation.box().export(path)
    return path


def refuse(*_):
    raise AssertionError("a child was asked")


def test_a_mesh_that_is_kept_is_the_one_that_was_read_and_takes_no_child(cube, monkeypatch):
    (read,) = open_meshes([cube]).values()
    monkeypatch.setattr(mesh_child, "_read_some", refuse)
    (kept,) = open_meshes([cube]).values()
    for one, other in (
        (read.vertices, kept.vertices),
        (read.faces, kept.faces),
        (read.hull.vertices, kept.hull.vertices),
        (read.hull.faces, kept.hull.faces),
    ):
        assert np.array_equal(one, other)
        assert one.dtype == other.dtype
        assert not other.flags.writeable
    known = ("name", "digest", "watertight", "convex", "notes", "diameter", "flat")
    assert [getattr(read, name) for name in known] == [getattr(kept, name) for name in known]


def test_another_content_and_another_name_are_other_meshes(cube):
    key = key_of(cube)
    named = cube.rename(cube.with_name("other.ply"))
    assert key_of(named) != key
    assert key_of(cube) is None  # there is no such file any more
    trimesh.creation.icosphere(1).export(cube)
    assert key_of(cube) not in (None, key)


@pytest.mark.slow
def test_what_is_refused_is_not_kept_and_a_file_cut_short_is_read_again(cube, tmp_path):
    bad = tmp_path / "bad.obj"
    bad.write_text("nonsense")
    results = open_meshes([bad, cube])
    (file,) = (tmp_path / "cache" / "harness" / KIND).iterdir()
    file.write_bytes(file.read_bytes()[:500])
    assert open_meshes([bad, cube])[bad] == results[bad]
    assert file.stat().st_size > 500


@pytest.mark.slow
def test_without_a_place_for_it_a_mesh_is_read_each_time(cube, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    for _ in range(2):
        (mesh,) = open_meshes([cube]).values()
        assert len(mesh.faces) == 12
