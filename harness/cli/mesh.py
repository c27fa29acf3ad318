"""Make, inspect, simplify and weld mesh files.

for example:
  harness mesh make pumpkin --faces 1753
  harness mesh inspect meshes/*.ply
  harness mesh simplify duck.obj --faces 1000 --out duck-1000.ply
  harness mesh weld scan.stl --within 1e-6 --out scan-welded.ply
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

from harness.cli.width import one_line, say
from harness.errors import InputError, Problem
from harness.vocabulary import MESH_FORMATS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from harness.scene.mesh import Mesh

SOLIDS = ("pumpkin", "icosphere", "cube")
# Sentences for the facts of a mesh, in the order in which they are printed.
FACTS = (
    ("faces", "faces"),
    ("vertices", "vertices"),
    ("watertight", "watertight"),
    ("open_edges", "open edges"),
    ("convex", "convex"),
    ("flat", "flat"),
    ("hull_vertices", "hull vertices"),
    ("diameter", "bounding diameter"),
    ("area", "area"),
    ("volume", "volume"),
    ("hull_volume", "hull volume"),
    ("hull_volume_ratio", "volume / hull volume"),
)


FORMATS_HEADING = "what is read of a file, told by the end of its name:"
FORMATS_NOTES = """\
Polygons of any number of corners are cut into triangles by ear clipping in their
own plane; faces without area are left out and counted. A mesh in one plane is
read, and has shape mesh alone. Text may be in any encoding
that holds ASCII. Not read: triangle strips of PLY, binary OFF, compressed, sparse
or normalised glTF, free-form surfaces, UTF-16."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    parser.epilog = "\n".join([FORMATS_HEADING, *map(_format_line, MESH_FORMATS), FORMATS_NOTES])
    actions = parser.add_subparsers(dest="action", required=True, metavar="make|inspect|simplify|weld")
    make = actions.add_parser("make", help="write a solid with a given number of faces")
    make.add_argument("solid", choices=SOLIDS)
    make.add_argument("--faces", type=int, metavar="N", help="how many; an odd number gives an open mesh")
    make.add_argument("--out", type=Path, metavar="FILE", help="a .ply file (default meshes/SOLID-N.ply)")
    make.add_argument("--force", action="store_true", help="overwrite the file if it is there")
    make.set_defaults(act=_make)
    inspect = actions.add_parser("inspect", help="print facts about mesh files")
    inspect.add_argument("files", type=Path, nargs="+", metavar="FILE", help="a file, or package:NAME/PATH")
    inspect.add_argument("--json", action="store_true", help="print one JSON document")
    inspect.set_defaults(act=_inspect)
    simplify = actions.add_parser("simplify", help="write a mesh of fewer faces and the same extent")
    simplify.add_argument("file", type=Path, metavar="FILE")
    simplify.add_argument("--faces", type=int, required=True, metavar="N")
    simplify.add_argument("--out", type=Path, required=True, metavar="FILE", help="a .ply file")
    simplify.add_argument("--force", action="store_true", help="overwrite the file if it is there")
    simplify.set_defaults(act=_simplify)
    weld = actions.add_parser("weld", help="write a mesh whose vertices within rounding of another are one with it")
    weld.add_argument("file", type=Path, metavar="FILE")
    weld.add_argument("--within", type=float, required=True, metavar="X", help="distance, in the unit of the file")
    weld.add_argument("--out", type=Path, metavar="FILE", help="a .ply file (default meshes/NAME-welded.ply)")
    weld.add_argument("--force", action="store_true", help="overwrite the file if it is there")
    weld.set_defaults(act=_weld)


def run(arguments: argparse.Namespace) -> int:
    """Make, inspect or simplify; wrong input is raised."""
    arguments.act(arguments)
    return 0


def _format_line(name: str) -> str:
    return fill(MESH_FORMATS[name], 76, initial_indent=f"  .{name}  ", subsequent_indent=8 * " ")


def _make(arguments: argparse.Namespace) -> None:
    from harness.scene.made_meshes import make

    vertices, faces = make(arguments.solid, arguments.faces)
    name = arguments.solid if arguments.faces is None else f"{arguments.solid}-{len(faces)}"
    _write(arguments.out or Path("meshes") / f"{name}.ply", vertices, faces, arguments.force)


def _simplify(arguments: argparse.Namespace) -> None:
    from harness.scene.simplify import simplify

    mesh = _opened_one(arguments.file)
    vertices, faces = simplify(mesh.vertices, mesh.faces, arguments.faces)
    _write(arguments.out, vertices * mesh.diameter, faces, arguments.force)


def _weld(arguments: argparse.Namespace) -> None:
    from harness.scene.weld import weld

    mesh = _opened_one(arguments.file)
    vertices, faces, welded = weld(mesh.vertices * mesh.diameter, mesh.faces, arguments.within)
    out = arguments.out or Path("meshes") / f"{arguments.file.stem}-welded.ply"
    notes = [f"{welded} {'vertex' if welded == 1 else 'vertices'} welded to another within {arguments.within:g}"]
    if lost := len(mesh.faces) - len(faces):
        notes.append(f"{lost} {'face' if lost == 1 else 'faces'} with two corners so welded left out")
    _write(out, vertices, faces, arguments.force, *notes)


def _inspect(arguments: argparse.Namespace) -> None:
    opened = _opened(arguments.files)
    facts = [{"file": str(path), **_facts(mesh)} for path, mesh in opened.items() if not isinstance(mesh, str)]
    if arguments.json:
        print(json.dumps({"meshes": facts}, indent=2))
    elif facts:
        print("\n\n".join(map(_paragraph, facts)))
    problems = [Problem(mesh) for mesh in opened.values() if isinstance(mesh, str)]
    if problems:
        raise InputError(problems)


def _opened(paths: list[Path]) -> dict[Path, Mesh | str]:
    """The meshes of files from anywhere, or of packages: read by a child process with limits."""
    from harness.experiment.mesh_location import PACKAGE, locate_mesh
    from harness.scene.mesh_child import open_meshes

    opened: dict[Path, Mesh | str] = {}
    located = dict[Path, Path]()
    for path in paths:
        try:
            located[path] = locate_mesh(str(path), Path()) if str(path).startswith(PACKAGE) else path
        except InputError as error:
            opened[path] = str(error)
    found = open_meshes(list(located.values()))
    opened |= {path: found[file] for path, file in located.items()}
    return {path: opened[path] for path in paths}


def _opened_one(path: Path) -> Mesh:
    """The mesh of one file; what is wrong with it is raised."""
    mesh = _opened([path])[path]
    if isinstance(mesh, str):
        raise InputError(mesh)
    return mesh


def _write(path: Path, vertices: NDArray[np.float64], faces: NDArray[np.int32], force: bool, *notes: str) -> None:
    """Write a mesh and say what it became, and more notes."""
    from harness.scene.mesh_file import make_mesh
    from harness.scene.ply_file import write_ply

    if path.suffix.lower() != ".ply":
        raise InputError(f"{path}: meshes are written as .ply")
    mesh = make_mesh(path.name, vertices, faces, notes)
    try:
        write_ply(path, vertices, faces, force)
    except FileExistsError as error:
        raise InputError(f"{path} is there already; --force overwrites it") from error
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror}") from error
    say(f"{path}: {len(faces)} faces, {len(mesh.vertices)} vertices, {len(mesh.hull.vertices)} of them on the hull")
    for note in mesh.notes:
        say(f"  note: {note}")
    if len(faces) % 2:
        say("  note: a closed surface of triangles has an even number of faces; with an odd number one is missing")


def _facts(mesh: Mesh) -> dict[str, Any]:
    """The facts of a mesh, in the unit of its file."""
    from harness.scene.topology import area, topology, volume

    about = topology(mesh.faces, len(mesh.vertices))
    enclosed = abs(volume(mesh.vertices, mesh.faces)) if mesh.watertight and about.turned == 0 else None
    hull = volume(mesh.hull.vertices, mesh.hull.faces)
    return {
        "faces": len(mesh.faces),
        "vertices": len(mesh.vertices),
        "watertight": mesh.watertight,
        "open_edges": about.boundary,
        "convex": mesh.convex,
        "flat": mesh.flat,
        "hull_vertices": len(mesh.hull.vertices),
        "diameter": mesh.diameter,
        "area": float(area(mesh.vertices, mesh.faces).sum()) * mesh.diameter**2,
        "volume": None if enclosed is None else enclosed * mesh.diameter**3,
        "hull_volume": hull * mesh.diameter**3,
        "hull_volume_ratio": None if enclosed is None or mesh.flat else enclosed / hull,
        "notes": list(mesh.notes),
    }


def _paragraph(facts: dict[str, Any]) -> str:
    """Facts for people: one a line."""
    lines = [one_line(facts["file"])]
    for key, name in FACTS:
        lines.append(f"  {name:22}{_shown(facts[key])}")
    return "\n".join([*lines, *(f"  note: {note}" for note in facts["notes"])])


def _shown(value: float | bool | None) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "–" if value is None else f"{value:.6g}"
