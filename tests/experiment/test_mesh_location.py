"""Meshes are found where they may be, and nowhere else."""

import os
import sys
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.experiment.mesh_location import locate_mesh


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with an experiment's folder, meshes/, and a package that must not be imported."""
    for name in (
        "lab/own.ply",
        "meshes/own.ply",
        "meshes/shared.ply",
        "secret.ply",
        "pack/__init__.py",
        "pack/data/p.obj",
    ):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("raise SystemExit('imported')")
    (tmp_path / "bare").mkdir()
    (tmp_path / "bare" / "b.obj").write_text("")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    return tmp_path.resolve()


def refused(reference: str) -> str:
    with pytest.raises(InputError) as caught:
        locate_mesh(reference, Path("lab"))
    return str(caught.value)


def test_beside_the_experiment_comes_first_then_meshes(places: Path) -> None:
    assert locate_mesh("own.ply", Path("lab")) == places / "lab" / "own.ply"
    assert locate_mesh("shared.ply", Path("lab")) == places / "meshes" / "shared.ply"
    assert locate_mesh("../meshes/own.ply", Path("lab")) == places / "meshes" / "own.ply"


def test_a_package_is_looked_into_without_being_imported(places: Path) -> None:
    assert locate_mesh("package:pack/data/p.obj", Path("lab")) == places / "pack" / "data" / "p.obj"
    assert "pack" not in sys.modules


def test_a_shipped_package_of_meshes_works() -> None:
    pytest.importorskip("pybullet_data", reason="pip install 'harness[pybullet]'")
    path = locate_mesh("package:pybullet_data/duck.obj", Path())
    assert path.name == "duck.obj"
    assert path.is_absolute()


def test_nothing_outside_can_be_reached(places: Path) -> None:
    (places / "lab" / "link.ply").symlink_to(places / "secret.ply")
    (places / "lab" / "loop.ply").symlink_to(places / "lab" / "loop.ply")
    for reference in ("../secret.ply", str(places / "secret.ply"), "link.ply", "/etc/passwd"):
        assert "lies outside of the experiment's folder and the folders of meshes" in refused(reference)
    assert "lies outside of the package pack" in refused("package:pack/../secret.ply")
    for reference in ("loop.ply", "a\x00b", "a" * 5000, ".", ""):
        assert "there is no mesh" in refused(reference)


def test_a_package_that_is_none_is_refused(places: Path) -> None:
    assert "is not installed" in refused("package:no_such_package/x.ply")
    assert "must be package:NAME/PATH" in refused("package:os.path/x.ply")
    assert "must be package:NAME/PATH" in refused("package:../x.ply")
    assert "could hold data" in refused("package:bare/b.obj")
    assert "could hold data" in refused("package:sys/b.obj")
    assert "could hold data" in refused("package:json5_or_not/b.obj") or "installed" in refused(
        "package:json5_or_not/b"
    )


def test_near_misses_are_named(places: Path) -> None:
    assert refused("shard.ply").endswith('did you mean "shared.ply"?')
    pytest.importorskip("pybullet_data", reason="pip install 'harness[pybullet]'")
    assert refused("package:pybullet_data/duk.obj").endswith('did you mean "package:pybullet_data/duck.obj"?')


def test_only_files_that_can_be_read_are_suggested(places: Path) -> None:
    (places / "lab" / "duckling.dae").write_text("")
    assert "did you mean" not in refused("duckling.obj")
    (places / "lab" / "duckling.stl").write_text("")
    assert 'did you mean "duckling.stl"?' in refused("duckling.obj")


def test_what_stands_there_and_is_no_file_is_called_what_it_is(places):
    (places / "lab/folder.obj").mkdir()
    os.mkfifo(places / "lab/pipe.obj")
    (places / "lab/gone.obj").symlink_to("nowhere")
    whats = {"folder": "a folder", "pipe": "a pipe or a device", "gone": "a link that leads to no file"}
    for name, what in whats.items():
        with pytest.raises(InputError, match=f": it is {what}$"):
            locate_mesh(f"{name}.obj", places / "lab")
    with pytest.raises(InputError, match=r"in meshes/$"):  # that there is such a folder outside is not told
        locate_mesh("../../", places / "lab")
