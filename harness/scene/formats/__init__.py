"""Mesh file formats: a file each, named as their files' names end, whose `read` turns a file's content into polygons.

A reader takes bytes, so that no file can name another one; it allocates nothing by what a header merely announces.
What it refuses it says in its own words, with the line where the file is text. A new format is a file of this folder,
and a line of `MESH_FORMATS` in `harness.vocabulary`; where its files can be told by their beginning, it has `BEGINS`,
a pattern.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from harness.scene.polygon_mesh import PolygonMesh
from harness.vocabulary import MESH_FORMATS

_READERS = {name: import_module(f"{__name__}.{name}") for name in MESH_FORMATS}

FORMATS: dict[str, Callable[[bytes], PolygonMesh]] = {name: module.read for name, module in _READERS.items()}
"""Readers by the extension of a file's name, without the dot, in lower case."""

BEGINNINGS: dict[str, bytes] = {name: module.BEGINS for name, module in _READERS.items() if hasattr(module, "BEGINS")}
"""How files of a format begin, as patterns."""
