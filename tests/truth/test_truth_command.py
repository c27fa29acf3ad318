"""`harness truth make` and `check`, the folder between them, and the errors of a declaration."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.truth.folder import CASES, README, read_set

ROOT = Path(__file__).parents[2]
DECLARED = """\
title: Cubes and spheres
families:
  random: {count: 4, meshes: [cube.ply], shapes: [mesh, sphere], spin: {uniform: [0, 5]}}
  flat_contacts: {count: 5, meshes: [cube.ply], spin: 3, window: 2}
  never: {count: 3, meshes: [cube.ply], shapes: [hull]}
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with a small set."""
    folder = tmp_path_factory.mktemp("truth")
    (folder / "small.yaml").write_text(DECLARED)
    assert main(["truth", "make", str(folder / "small.yaml"), "--out", str(folder / "set")]) == 0
    return folder / "set"


def rows_of(folder):
    with (folder / CASES).open(newline="") as stream:
        return list(csv.reader(stream))


def copy_with(made, folder, changes):
    """A copy of the set with other values in places (row, column)."""
    rows = rows_of(made)
    for (row, column), value in changes.items():
        rows[row][rows[0].index(column)] = value
    folder.mkdir()
    (folder / "meshes").symlink_to(made / "meshes")
    with (folder / CASES).open("w", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows(rows)
    return folder


def first_touching(rows):
    upper = rows[0].index("upper")
    return next(place for place, row in enumerate(rows[1:], 1) if row[upper] not in ("", "0"))


def test_what_was_made_is_as_many_as_declared_and_every_case_is_proven_anew(made, capsys):
    cases = read_set(made).cases
    assert cases.families.tolist() == ["random"] * 4 + ["flat_contacts"] * 5 + ["never"] * 3
    assert np.isinf(cases.upper[-3:]).all()
    assert ((cases.upper - cases.lower)[np.isfinite(cases.upper)] <= 1e-9).all()
    assert main(["truth", "check", str(made)]) == 0
    assert capsys.readouterr().out == "12 of 12 cases are proven\n"


@pytest.mark.slow
def test_a_bracket_moved_by_a_millionth_of_a_second_is_refused_with_its_line(made, tmp_path, capsys):
    rows = rows_of(made)
    place = first_touching(rows)
    moved = {(place, name): repr(float(rows[place][rows[0].index(name)]) + 1e-6) for name in ("lower", "upper")}
    assert main(["truth", "check", str(copy_with(made, tmp_path / "late", moved))]) == 1
    out = capsys.readouterr().out
    assert out.startswith(f"cases.csv:{place + 1}: not proven apart at ")
    assert out.endswith("11 of 12 cases are proven\n")


@pytest.mark.slow
def test_a_body_that_starts_elsewhere_or_a_touch_said_to_be_none_is_refused(made, tmp_path):
    rows = rows_of(made)
    place = first_touching(rows)
    nearer = repr(float(rows[place][rows[0].index("x_b")]) + 1e-3)
    assert main(["truth", "check", str(copy_with(made, tmp_path / "nearer", {(place, "x_b"): nearer}))]) == 1
    window = rows[place][rows[0].index("window")]
    none = {(place, "lower"): window, (place, "upper"): "", (place, "verdict"): "never"}
    assert main(["truth", "check", str(copy_with(made, tmp_path / "none", none))]) == 1


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("size_a", "0", "size_a must be finite, and a size above 0, not 0"),
        ("x_a", "here", 'x_a is no number: "here"'),
        ("shape", "cloud", 'shape must be sphere, hull, mesh, not "cloud"'),
        ("x_a", "-1e31", "x_a must be within 1e+30, and a size at least 1e-30, not -1e+31"),
        ("size_a", "1e-320", "size_a must be within 1e+30, and a size at least 1e-30, not 9.99989e-321"),
        ("mesh_a", "../meshes/cube", "mesh_a: there is no meshes/../meshes/cube.obj"),
        ("mesh_b", "m" * 300, f"mesh_b: there is no meshes/{'m' * 60}….obj"),
        ("verdict", "maybe", "verdict must be touches, or never with no upper bound"),
    ],
)
def test_a_table_that_makes_no_sense_is_an_error_at_its_line(made, tmp_path, capsys, column, value, message):
    assert main(["truth", "check", str(copy_with(made, tmp_path / "odd", {(2, column): value}))]) == 2
    assert capsys.readouterr().err.strip() == f"{tmp_path / 'odd' / CASES}:3: {message}"


def test_a_mesh_that_makes_no_sense_is_refused_with_its_line(made, tmp_path, capsys):
    folder = copy_with(made, tmp_path / "odd", {})
    (folder / "meshes").unlink()
    (folder / "meshes").mkdir()
    mesh = next((made / "meshes").iterdir())
    lines = mesh.read_text().splitlines()
    wrongs = {
        "v 0 x 0": 'line 1: "x" is not a number',
        "f 1 2 3 4": "a face that is no triangle",
        "v 1e31 0 0": "coordinates beyond 1e+30",
        "f 1 2 999": "names vertices that it does not",
    }
    for line, reason in wrongs.items():
        (folder / "meshes" / mesh.name).write_text("\n".join([line, *lines]))
        assert main(["truth", "check", str(folder)]) == 2
        assert reason in capsys.readouterr().err
    rows = rows_of(made)
    (folder / CASES).write_text(",".join(rows[0]) + "\n")
    assert main(["truth", "check", str(folder)]) == 2
    assert capsys.readouterr().err.strip().endswith(":1: there are no cases behind the first line")


@pytest.mark.parametrize("folder", [None, ROOT / "results" / "published" / "truth"])
def test_the_reader_of_the_readme_reads_what_the_check_reads(made, folder):
    folder = folder or made
    block = re.search(r"```python\n(.*?)```", (folder / README).read_text(encoding="utf-8"), re.DOTALL)
    assert len(block[1].splitlines()) <= 22
    assert "numpy" not in block[1]
    names: dict = {}
    exec(block[1], names)
    read = list(names["cases"](str(folder))) if folder is made else [next(names["cases"](str(folder)))]
    given = read_set(folder) if folder is made else None
    for place, (family, shape, one, other, window, bounds) in enumerate(read):
        if given is None:
            assert family == "random"
            assert window == 4.0
            continue
        cases = given.cases
        assert (family, window) == (cases.families[place], cases.windows[place])
        assert bounds == (cases.lower[place], cases.upper[place])
        for body, side in ((one, cases.first), (other, cases.second)):
            surface = given.solids.all[side.meshes[place]].surface
            if shape == "mesh":
                assert body[0] == (surface.vertices.tolist(), surface.faces.tolist())
            assert body[1] == side.sizes[place]
            columns = (side.positions, side.quaternions, side.velocities, side.spins)
            assert list(body[2:]) == [column[place].tolist() for column in columns]


def test_everything_wrong_with_a_declaration_is_said_with_its_place(tmp_path, capsys):
    path = tmp_path / "wrong.yaml"
    path.write_text(
        "title: Wrong\n"
        "families:\n"
        "  random: {count: 0, meshes: [cube.ply]}\n"
        "  grazzing: {count: 1, meshes: [cube.ply]}\n"
    )
    assert main(["truth", "make", str(path), "--out", str(tmp_path / "set")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == f"{path}:3:19: count must be at least 1, not 0"
    assert lines[1] == f'{path}:4:3: unknown key "grazzing"; did you mean "grazing"?'
    path.write_text("title: Wrong\nfamilies:\n  random: {count: 1, meshes: [cub.ply]}\n")
    assert main(["validate", str(path)]) == 2
    assert capsys.readouterr().err.startswith(f'{path}:3:31: there is no mesh "cub.ply"')


def test_a_folder_that_takes_no_files_is_refused_before_the_work(tmp_path, capsys, monkeypatch):
    (tmp_path / "small.yaml").write_text(DECLARED)
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("harness.truth.make.make", None)  # which would take its time
    for out, reason in (("file", "File exists"), ("file/below", "Not a directory")):
        assert main(["truth", "make", str(tmp_path / "small.yaml"), "--out", str(tmp_path / out)]) == 2
        assert f"{tmp_path / out}: cannot be written: {reason}; give another folder" in capsys.readouterr().err


def test_a_folder_of_experiments_may_hold_declarations_of_sets(tmp_path, capsys):
    (tmp_path / "set.yaml").write_text(DECLARED)
    assert main(["validate", str(tmp_path)]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'set.yaml'}: a set of 12 cases in 3 families\n"
    assert main(["sweep", str(tmp_path / "set.yaml")]) == 2
    assert "harness truth make" in capsys.readouterr().err
    assert main(["validate", str(ROOT / "experiments" / "truth")]) == 0
