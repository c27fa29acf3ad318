import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from harness.cli.main import main
from harness.scene.formats import FORMATS
from harness.scene.mesh_file import read_mesh


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_made_pumpkins_go_to_meshes_and_are_not_overwritten_unasked(capsys):
    command = ["mesh", "make", "pumpkin", "--faces", "501"]
    assert main(command) == 0
    assert "501 faces" in (said := capsys.readouterr().out)
    assert "even number of faces" in said
    assert len(read_mesh("meshes/pumpkin-501.ply").faces) == 501
    assert main(command) == 2
    assert "--force" in capsys.readouterr().err
    assert main([*command, "--force"]) == 0


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("make pumpkin", "how many faces"),
        ("make pumpkin --faces 12", "at least 40"),
        ("make icosphere --faces 100", "not 100"),
        ("make cube --faces 14", "12 faces"),
        ("make cube --out cube.stl", "written as .ply"),
        pytest.param("inspect none.obj", "none.obj: there is no such mesh file", marks=pytest.mark.slow),
        pytest.param(
            "simplify none.obj --faces 10 --out a.ply", "none.obj: there is no such mesh file", marks=pytest.mark.slow
        ),
    ],
)
def test_wrong_input_is_one_sentence_and_exit_2(words, reason, capsys):
    assert main(["mesh", *words.split()]) == 2
    said = capsys.readouterr().err.strip()
    assert reason in said
    assert "\n" not in said


def test_files_of_installed_packages_are_named_as_experiments_name_them(capsys):
    pytest.importorskip("pybullet_data", reason="pip install 'harness[pybullet]'")
    assert main(["mesh", "inspect", "package:pybullet_data/duck.obj", "package:pybullet_data/dukc.obj", "--json"]) == 2
    told = capsys.readouterr()
    (duck,) = json.loads(told.out)["meshes"]
    assert (duck["file"], duck["faces"]) == ("package:pybullet_data/duck.obj", 4212)
    assert 'did you mean "package:pybullet_data/duck.obj"?' in told.err


def test_inspect_says_the_facts_in_the_unit_of_the_file(capsys):
    trimesh.creation.box(extents=[2, 2, 2]).export("cube.stl")
    Path("bad.obj").write_text("nonsense")
    assert main(["mesh", "inspect", "cube.stl", "bad.obj", "--json"]) == 2
    said = capsys.readouterr()
    (facts,) = json.loads(said.out)["meshes"]
    assert said.err.startswith("bad.obj: ")
    assert facts["faces"] == 12
    assert facts["watertight"]
    assert facts["convex"]
    assert [facts[key] for key in ("diameter", "area", "volume", "hull_volume_ratio")] == pytest.approx(
        [np.sqrt(12), 24, 8, 1]
    )
    assert main(["mesh", "inspect", "cube.stl"]) == 0
    assert "bounding diameter     3.4641" in capsys.readouterr().out


def test_simplify_keeps_the_extent():
    trimesh.creation.icosphere(4, radius=20).export("ball.obj")
    assert main(["mesh", "simplify", "ball.obj", "--faces", "400", "--out", "coarse.ply"]) == 0
    assert len(read_mesh("coarse.ply").faces) == 400
    assert read_mesh("coarse.ply").diameter == pytest.approx(40, rel=1e-7)


def test_weld_closes_a_mesh_whose_vertices_lie_within_rounding_and_says_how_many(capsys):
    ball = trimesh.creation.icosphere(2)
    cracked = ball.triangles.reshape(-1, 3) + np.random.default_rng(259).uniform(-1e-9, 1e-9, (3 * len(ball.faces), 3))
    rows = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in cracked.tolist()]
    rows += [f"f {k} {k + 1} {k + 2}\n" for k in range(1, len(cracked), 3)]
    Path("cracked.obj").write_text("".join(rows))
    assert not read_mesh("cracked.obj").watertight
    assert main(["mesh", "weld", "cracked.obj", "--within", "1e-8"]) == 0
    assert f"{len(cracked) - len(ball.vertices)} vertices welded to another within 1e-08" in capsys.readouterr().out
    welded = read_mesh("meshes/cracked-welded.ply")
    assert welded.watertight
    assert len(welded.vertices) == len(ball.vertices)
    assert welded.diameter == pytest.approx(2, rel=1e-8)


def test_weld_leaves_out_faces_that_lose_a_corner(capsys):
    cube = trimesh.creation.box()
    Path("cube.obj").write_text(cube.export(file_type="obj") + "\nv 0.5 0.4999 0.4999\nf 7 8 9\n")
    assert main(["mesh", "weld", "cube.obj", "--within", "1e-3", "--out", "cube.ply"]) == 0
    assert "1 face with two corners so welded left out" in capsys.readouterr().out
    assert len(read_mesh("cube.ply").faces) == 12


@pytest.mark.parametrize("within", ["0", "-1", "nan", "inf", "9"])
def test_weld_refuses_a_distance_that_is_none_of_rounding(within, capsys):
    trimesh.creation.box().export("cube.ply")
    assert main(["mesh", "weld", "cube.ply", f"--within={within}", "--out", "a.ply"]) == 2
    assert not Path("a.ply").exists()


def test_help_has_a_line_for_each_format_that_is_read(capsys):
    with pytest.raises(SystemExit):
        main(["mesh", "--help"])
    said = capsys.readouterr().out
    assert all(f"  .{form}  " in said for form in FORMATS)
