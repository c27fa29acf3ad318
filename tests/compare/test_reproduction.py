"""What `--save` writes shows the defect by itself, with no more bodies than it takes."""

import errno
import json
import os

import pytest

from harness.cli.main import main
from harness.compare import reproduction
from harness.experiment.load import load

EXPERIMENT = """
title: Three
scene:
  shape: sphere
  box: [9, 9, 9]
  bodies:
    - {position: [0.123456789, 0, 0]}
    - {position: [3, 0, 0]}
    - {position: [0.5, 0.3, 0]}
    - {position: [0, 3, 0]}
motion: {duration: 0, response: none}
"""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "bodies"), [("swaps", 3), ("inflates", 2)])
def test_a_saved_disagreement_is_found_again(name, bodies, defective, tmp_path, capsys):
    path = tmp_path / "three.yaml"
    text = EXPERIMENT if name == "swaps" else EXPERIMENT.replace("[3, 0, 0]", "[-0.8769, 0, 0]")
    path.write_text(text)
    assert main(["compare", str(path), "--backends", f"fcl,{defective(name)}", "--save", str(tmp_path), "--json"]) == 1
    cases = json.loads(capsys.readouterr().out)["cases"]
    files = {case["file"] for case in cases}
    assert None not in files
    for file in files:
        assert len(load(file).points[0].scene.bodies) == bodies
        assert main(["compare", file, "--json"]) == 1
        assert json.loads(capsys.readouterr().out)["cases"][0]["wrong"] == name


# A cube and a needle.
CUBE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n" + "".join(
    f"f {corners}\n" for corners in ("1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6")
)
NEEDLE = "v -1 0 0\nv 1 0 0\nv 0 0.01 0\nv 0 0 0.01\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
SAME_NAMES = """
title: Two parts
scene:
  shape: hull
  box: [9, 9, 9]
  bodies:
    - {mesh: one/part.obj, position: [0, 0, 0]}
    - {mesh: other/part.obj, position: [0.76, 0, 0]}
motion: {duration: 0, response: none}
"""


def test_meshes_of_one_name_are_saved_as_two(defective, tmp_path, capsys):
    for folder, text in (("one", CUBE), ("other", NEEDLE)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "part.obj").write_text(text)
    (tmp_path / "parts.yaml").write_text(SAME_NAMES)
    saved, backends = tmp_path / "saved", f"fcl,{defective('blind')}"
    for _ in range(2):  # what is there already is taken for what it is
        assert main(["compare", "parts.yaml", "--backends", backends, "--save", str(saved), "--json"]) == 1
        (file,) = {case["file"] for case in json.loads(capsys.readouterr().out)["cases"]}
        meshes = {body.mesh for body in load(file).points[0].scene.bodies}
        assert {(saved / mesh).read_text() for mesh in meshes} == {CUBE, NEEDLE}
        assert {path.name for path in saved.glob("*.obj")} == meshes


@pytest.mark.slow
def test_what_is_found_is_said_though_it_cannot_be_saved(defective, tmp_path, capsys, monkeypatch):
    def full(path, content):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    (tmp_path / "three.yaml").write_text(EXPERIMENT)
    compare = ["compare", str(tmp_path / "three.yaml"), "--backends", f"fcl,{defective('swaps')}", "--json"]
    monkeypatch.setattr(reproduction, "write_whole", full)
    assert main([*compare, "--save", str(tmp_path / "cases")]) == 2
    said = capsys.readouterr()
    assert {(case["wrong"], case["file"]) for case in json.loads(said.out)["cases"]} == {("swaps", None)}
    assert said.err.splitlines()[-1].endswith(
        "cannot be written: No space left on device; give another folder with --save"
    )


def test_a_folder_for_cases_that_cannot_be_is_refused_before_the_work(tmp_path, capsys):
    (tmp_path / "three.yaml").write_text(EXPERIMENT)
    assert main(["compare", str(tmp_path / "three.yaml"), "--save", str(tmp_path / "three.yaml")]) == 2
    assert capsys.readouterr().err.endswith(
        "three.yaml: cannot be written: File exists; give another folder with --save\n"
    )
