"""A set of cases as a folder that anyone can use without harness: `cases.csv`, its meshes as OBJ files, a README."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, get_args

import numpy as np

from harness.arrays import Floats
from harness.errors import InputError, Problem
from harness.experiment.messages import printable, shown
from harness.scene.formats import obj
from harness.scene.mesh import Surface
from harness.truth.cases import Cases
from harness.truth.flights import Flights
from harness.truth.solids import Solids
from harness.vocabulary import Shape
from harness.whole_file import write_whole

CASES, MESHES, README = "cases.csv", "meshes", "README.md"
MOTION = ("x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")
COLUMNS = (
    *("family", "shape"),
    *(f"{name}_{body}" for body in "ab" for name in ("mesh", "size", *MOTION)),
    *("window", "lower", "upper", "verdict"),
)
# m, m/s, rad/s and s, as for the numbers of an experiment: squares of what lies beyond overflow or underflow.
LARGEST, SMALLEST = 1e30, 1e-30
NEVER, TOUCHES = "never", "touches"


class TruthSet(NamedTuple):
    """What a folder holds.

    Attributes
    ----------
    cases : Cases
    solids : Solids that their flights name
    lines : of each case, in cases.csv
    """

    cases: Cases
    solids: Solids
    lines: list[int]


def read_set(folder: Path) -> TruthSet:
    """Read a folder.

    Raises
    ------
    InputError
        If a file is missing, or says what cannot be, with its line.
    """
    path = folder / CASES
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.reader(stream))
    except OSError as error:
        why = f"the cases cannot be read: {error.strerror}; `harness truth make` writes such a folder"
        raise InputError([Problem(why, str(path))]) from None
    except UnicodeDecodeError:
        raise InputError([Problem("the cases cannot be read: this is not UTF-8 text", str(path))]) from None
    except csv.Error:
        raise InputError(
            [Problem("the cases cannot be read: this is no CSV, or a value is too long", str(path))]
        ) from None
    if not rows or tuple(rows[0]) != COLUMNS:
        raise InputError([Problem(f"the first line must name the columns {', '.join(COLUMNS)}", str(path), 1)])
    if len(rows) == 1:
        raise InputError([Problem("there are no cases behind the first line", str(path), 1)])
    problems = [
        Problem(message, str(path), line)
        for line, row in enumerate(rows[1:], 2)
        if (message := _wrong(row, folder)) is not None
    ]
    if problems:
        raise InputError(problems)
    table = [dict(zip(COLUMNS, row, strict=True)) for row in rows[1:]]
    keys = [(row["mesh_a"], row["mesh_b"]) for row in table]
    surfaces = {
        name: read_obj(folder / MESHES / f"{name}.obj") for name in sorted({n for key in keys for n in key if n})
    }
    solids = Solids(surfaces, [(row[mesh], _shape(row)) for row in table for mesh in ("mesh_a", "mesh_b")])
    return TruthSet(_cases(table, solids), solids, list(range(2, len(rows) + 1)))


def write_set(folder: Path, cases: Cases, solids: Solids, surfaces: Mapping[str, Surface], readme: str) -> None:
    """Write a folder; files of the same names are replaced."""
    write_whole(folder / CASES, cases_text(cases, solids))
    for name in sorted({solids.all[mesh].mesh for side in (cases.first, cases.second) for mesh in side.meshes} - {""}):
        write_whole(folder / MESHES / f"{name}.obj", obj_text(surfaces[name]))
    write_whole(folder / README, readme)


def cases_text(cases: Cases, solids: Solids) -> str:
    """The text of cases.csv: every number in the fewest digits that give the same float."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    for place in range(cases.number):
        row: list[str] = [str(cases.families[place]), solids.all[cases.first.meshes[place]].shape]
        for side in (cases.first, cases.second):
            numbers = [side.sizes[place]]
            for column in (side.positions, side.quaternions, side.velocities, side.spins):
                numbers += column[place].tolist()
            row += [solids.all[side.meshes[place]].mesh, *map(shortest_text, numbers)]
        never = bool(np.isinf(cases.upper[place]))
        row += [shortest_text(cases.windows[place]), shortest_text(cases.lower[place])]
        row += ["", NEVER] if never else [shortest_text(cases.upper[place]), TOUCHES]
        writer.writerow(row)
    return out.getvalue()


def shortest_text(number: float) -> str:
    """The shortest text that gives the same float.

    >>> shortest_text(2.0), shortest_text(0.1), shortest_text(-0.0), shortest_text(1e-7)
    ('2', '0.1', '0', '1e-07')
    """
    return repr(float(number) + 0.0).removesuffix(".0")


def obj_text(surface: Surface) -> str:
    """A surface as an OBJ file."""
    lines = ["v " + " ".join(map(shortest_text, vertex)) for vertex in surface.vertices.tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in surface.faces.tolist()]
    return "\n".join([*lines, ""])


def read_obj(path: Path) -> Surface:
    """The surface of one of the folder's files, whose numbers are taken as they stand.

    Raises
    ------
    InputError
        If it is no such file.
    """
    try:
        found = obj.read(path.read_bytes())
    except OSError as error:
        raise InputError([Problem(f"the mesh cannot be read: {error.strerror}", str(path))]) from None
    except InputError as error:
        raise InputError([Problem(str(error), str(path))]) from None
    if (found.lengths != 3).any():
        raise InputError([Problem("the mesh has a face that is no triangle", str(path))])
    vertices, faces = found.vertices, found.corners.reshape(-1, 3)
    if faces.min() < 0 or faces.max() >= len(vertices) or not np.isfinite(vertices).all():
        raise InputError([Problem("the mesh names vertices that it does not have, or that are not finite", str(path))])
    if np.abs(vertices).max() > LARGEST:
        raise InputError([Problem(f"the mesh has coordinates beyond {LARGEST:g}", str(path))])
    return Surface(vertices, faces.astype(np.int32))


def _is_mesh(folder: Path, name: str) -> bool:
    """Whether a folder has a mesh of this name, which leads to no other folder."""
    if not name.isprintable() or Path(name).name != name:
        return False
    try:
        return (folder / MESHES / f"{name}.obj").is_file()
    except OSError:  # a name too long
        return False


def _wrong(row: Sequence[str], folder: Path) -> str | None:
    """What is wrong with the text of a case."""
    if len(row) != len(COLUMNS):
        return f"has {len(row)} values; there are {len(COLUMNS)} columns"
    named = dict(zip(COLUMNS, row, strict=True))
    if named["shape"] not in get_args(Shape):
        return f"shape must be {', '.join(get_args(Shape))}, not {shown(named['shape'])}"
    for name in ("mesh_a", "mesh_b"):
        if (named["shape"] != "sphere" or named[name]) and not _is_mesh(folder, named[name]):
            return f"{name}: there is no {MESHES}/{printable(named[name])}.obj"
    if named["verdict"] not in (NEVER, TOUCHES) or (named["verdict"] == NEVER) != (named["upper"] == ""):
        return f"verdict must be {TOUCHES}, or {NEVER} with no upper bound"
    for name in COLUMNS:
        if name in ("family", "shape", "mesh_a", "mesh_b", "verdict") or (name == "upper" and not named[name]):
            continue
        try:
            number = float(named[name])
        except ValueError:
            return f"{name} is no number: {shown(named[name])}"
        if not math.isfinite(number) or (name.startswith("size") and number <= 0.0):
            return f"{name} must be finite, and a size above 0, not {printable(named[name])}"
        if abs(number) > LARGEST or (name.startswith("size") and number < SMALLEST):
            return f"{name} must be within {LARGEST:g}, and a size at least {SMALLEST:g}, not {number:g}"
    for body in "ab":
        if math.hypot(*(float(named[f"{part}_{body}"]) for part in ("qw", "qx", "qy", "qz"))) < SMALLEST:
            return "a quaternion is zero, which turns into no direction"
    return None


def _shape(row: Mapping[str, str]) -> Shape:
    return next(shape for shape in get_args(Shape) if shape == row["shape"])


def _cases(table: Sequence[Mapping[str, str]], solids: Solids) -> Cases:
    def column(*names: str) -> Floats:
        return np.array([[float(row[name]) for name in names] for row in table], np.float64).reshape(-1, len(names))

    def side(body: str) -> Flights:
        numbers = column(*(f"{name}_{body}" for name in MOTION))
        meshes = np.array([solids.number(row[f"mesh_{body}"], _shape(row)) for row in table], np.int64)
        return Flights(
            meshes, column(f"size_{body}")[:, 0], numbers[:, :3], numbers[:, 3:7], numbers[:, 7:10], numbers[:, 10:]
        )

    return Cases(
        np.array([row["family"] for row in table], np.str_),
        side("a"),
        side("b"),
        column("window")[:, 0],
        column("lower")[:, 0],
        np.array([float(row["upper"]) if row["upper"] else np.inf for row in table]),
    )
