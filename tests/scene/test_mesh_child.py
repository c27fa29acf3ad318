import numpy as np
import psutil
import pytest
import trimesh

from harness.errors import InputError
from harness.scene import mesh_child
from harness.scene.mesh_child import open_all, open_meshes
from harness.scene.mesh_file import read_mesh

MIB = 1024**2


@pytest.fixture
def cube(tmp_path):
    path = tmp_path / "cube.ply"
    trimesh.creation.box().export(path)
    return path


@pytest.fixture
def large(tmp_path):
    """A mesh that takes some seconds and hundreds of MiB to read."""
    path = tmp_path / "large.obj"
    rows = [f"v {k} {k * k % 977} {k % 13}\n" for k in range(500_000)]
    path.write_text("".join(rows + [f"f {k} {k + 1} {k + 2}\n" for k in range(1, 499_000)]))
    return path


@pytest.fixture
def bad_reader(tmp_path, monkeypatch):
    """A reader in the child that does as the name of the file says: `signal.9.ply`, `exit.3.ply`."""
    package = tmp_path / "package" / "sitecustomize.py"
    package.parent.mkdir()
    package.write_text(
        "import sys\n"
        "if 'harness.scene.mesh_child' in ' '.join(sys.orig_argv):\n"
        "    import os, signal\n"
        "    from harness.scene import mesh_file\n"
        "    good = mesh_file.read_mesh\n"
        "    def read_mesh(path):\n"
        "        kind, number, *_ = path.name.split('.') + ['0']\n"
        "        print('garbage', flush=True)\n"
        "        if kind == 'signal':\n"
        "            os.kill(os.getpid(), int(number))\n"
        "        if kind == 'exit':\n"
        "            os._exit(int(number))\n"
        "        return good(path)\n"
        "    mesh_file.read_mesh = read_mesh\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(package.parent))


def test_a_mesh_comes_back_as_it_was_read(cube):
    here, there = read_mesh(cube), open_meshes([cube])[cube]
    assert not isinstance(there, str)
    assert np.array_equal(here.vertices, there.vertices)
    assert np.array_equal(here.hull.faces, there.hull.faces)
    assert (here.name, here.digest, here.notes, here.diameter) == (
        there.name,
        there.digest,
        there.notes,
        there.diameter,
    )
    assert there.watertight
    assert there.convex
    assert not there.vertices.flags.writeable


def test_no_files_take_no_child():
    assert open_meshes([]) == {}


@pytest.mark.slow
def test_bad_files_cost_only_themselves(cube, tmp_path):
    (tmp_path / "bad.obj").write_text("nonsense")
    results = open_meshes([tmp_path / "bad.obj", cube, tmp_path / "none.ply", cube])
    assert list(results) == [tmp_path / "bad.obj", cube, tmp_path / "none.ply"]
    assert [isinstance(result, str) for result in results.values()] == [True, False, True]
    with pytest.raises(InputError) as caught:
        open_all(results)
    assert len(caught.value.problems) == 2


@pytest.mark.slow
def test_a_file_that_takes_too_much_memory_costs_only_itself(cube, large):
    results = open_meshes([large, cube], memory=100 * MIB)
    assert results[large] == "large.obj: reading it takes more than 0.0977 GiB of memory"
    assert not isinstance(results[cube], str)


@pytest.mark.slow
def test_a_file_that_takes_too_long_costs_only_itself(cube, large):
    results = open_meshes([large, cube], timeout=0.5)
    assert results[large] == "large.obj: reading it took longer than 0.5 s"
    assert not isinstance(results[cube], str)


@pytest.mark.slow
def test_a_crash_costs_only_its_file_and_is_named(cube, tmp_path, bad_reader):
    crashed, killed, left = (tmp_path / name for name in ("signal.11.ply", "signal.9.ply", "exit.3.ply"))
    results = open_meshes([crashed, killed, left, cube])
    assert results[crashed] == "signal.11.ply: reading it crashed (SIGSEGV)"
    assert "killed (SIGKILL)" in results[killed]
    assert results[left] == "exit.3.ply: the reader ended without an answer (exit 3)"
    assert not isinstance(results[cube], str)


def test_the_child_is_gone_when_a_file_took_too_long(tmp_path, monkeypatch):
    monkeypatch.setattr(mesh_child, "START_SECONDS", 0.0)
    before = psutil.Process().children()  # other tests may have left helpers of theirs
    assert "took longer than 0 s" in open_meshes([tmp_path / "any.ply"])[tmp_path / "any.ply"]
    assert psutil.Process().children() == before
