"""What a file is whose content is not what its name says, told by how it begins."""

from __future__ import annotations

import re

from harness.scene.formats import BEGINNINGS

# What no reader takes, and what a person can do about it.
OTHERS = (
    (rb"version https://git-lfs", "a pointer of Git LFS, not the mesh itself; git lfs pull brings that"),
    (rb"(?i)<!doctype html|<html", "a web page"),
    (rb"(?s)<\?xml.{0,2000}<COLLADA", "a COLLADA file, which is not read"),
    (rb"<\?xml|<[A-Za-z]", "an XML file, which is not read"),
    (rb"\{", "a JSON file, which is not read; glTF is read as .glb"),
    (rb"\x1f\x8b|BZh|\xfd7zXZ|PK\x03\x04|7z\xbc\xaf|Rar!", "a compressed file; unpack it first"),
    (rb"ISO-10303-21", "a STEP file, which is not read"),
    (rb"Kaydara FBX Binary|; FBX", "an FBX file, which is not read"),
    (rb"#VRML", "a VRML file, which is not read"),
    (rb"xof ", "a DirectX file, which is not read"),
    (rb"BLENDER", "a file of Blender, which is not read"),
    (rb"%PDF|\x89PNG|\xff\xd8\xff", "a document or a picture"),
)


def recognised(content: bytes, form: str) -> str | None:
    """What a file is that could not be read as a format; None if it may well be of that format."""
    start = content[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
    for name, pattern in BEGINNINGS.items():
        if re.match(pattern, start):
            return None if name == form else f"this is a file of another format: name it .{name}"
    for pattern, what in OTHERS:
        if re.match(pattern, start):
            return f"this is {what}"
    return None
