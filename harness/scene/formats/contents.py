"""What stands under the name of a mesh file where that is no mesh, or not of the format that its name says."""

from __future__ import annotations

import re
from pathlib import Path

from harness.scene.formats import BEGINNINGS
from harness.scene.formats.stl import is_binary

# What no reader takes, and what a person can do about it.
OTHERS = (
    (rb"version https://git-lfs", "a pointer of Git LFS, not the mesh itself; git lfs pull brings that"),
    (rb"/annex/objects/", "a pointer of git-annex, not the mesh itself; git annex get brings that"),
    (rb"(?is)(?:<!--.{0,2000}?-->\s*)?(?:<!doctype html|<html)", "a web page"),
    (rb"(?s)<\?xml.{0,2000}<COLLADA", "a COLLADA file, which is not read"),
    (rb"<\?xml|<[A-Za-z]|<!--", "an XML file, which is not read"),
    (rb"\{", "a JSON file, which is not read; glTF is read as .glb"),
    (
        rb"\x1f[\x8b\x9d]|BZh|\xfd7zXZ|PK\x03\x04|7z\xbc\xaf|Rar!|\x28\xb5\x2f\xfd|\x5d\0\0|x[\x01\x9c\xda]",
        "a compressed file; unpack it first",
    ),
    (rb"(?s).{257}ustar", "an archive; unpack it first"),
    (rb"ISO-10303-21", "a STEP file, which is not read"),
    (rb"Kaydara FBX Binary|; FBX", "an FBX file, which is not read"),
    (rb"#VRML", "a VRML file, which is not read"),
    (rb"# vtk DataFile", "a VTK file, which is not read"),
    (rb"\$MeshFormat", "a file of Gmsh, which is not read"),
    (rb"xof ", "a DirectX file, which is not read"),
    (rb"BLENDER", "a file of Blender, which is not read"),
    (rb"%PDF|\x89PNG|\xff\xd8\xff", "a document or a picture"),
)
OTHER_FORMAT = "this is a file of another format: name it .{}"


def no_file(path: Path) -> str | None:
    """Why there is nothing to read at a path; None if a file is there.

    Raises
    ------
    OSError
        If it cannot be looked at, or links lead round in a circle.
    """
    try:
        path.stat()
    except FileNotFoundError:
        return "this is a link to a file that there is not" if path.is_symlink() else "there is no such mesh file"
    if path.is_dir():
        return "this is a folder, not a mesh file"
    return None if path.is_file() else "this is a pipe or a device, not a mesh file"


def recognised(content: bytes, form: str) -> str | None:
    """What a file is that could not be read as a format; None if it may well be of that format."""
    start = content[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
    for name, pattern in BEGINNINGS.items():
        if re.match(pattern, start):
            return None if name == form else OTHER_FORMAT.format(name)
    if form != "stl" and is_binary(content):
        return OTHER_FORMAT.format("stl")
    for pattern, what in OTHERS:
        if re.match(pattern, start):
            return f"this is {what}"
    return None
