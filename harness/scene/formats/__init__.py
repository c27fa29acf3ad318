"""Mesh file formats: one file each, which turns the content of a file into polygons.

A reader takes bytes, so that no file can name another one; it allocates nothing by what a header merely announces.
What it refuses it says in its own words, with the line where the file is text.
"""

from __future__ import annotations

from collections.abc import Callable

from harness.scene.formats.glb import read_glb
from harness.scene.formats.obj import read_obj
from harness.scene.formats.off import read_off
from harness.scene.formats.ply import read_ply
from harness.scene.formats.stl import read_stl
from harness.scene.polygon_mesh import PolygonMesh

FORMATS: dict[str, Callable[[bytes], PolygonMesh]] = {
    "glb": read_glb,
    "obj": read_obj,
    "off": read_off,
    "ply": read_ply,
    "stl": read_stl,
}
"""Readers by the extension of a file's name, without the dot, in lower case."""
