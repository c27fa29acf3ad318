"""Mesh files in all the ways in which programs and people write them, of solids whose area and volume are known."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from copy import deepcopy
from typing import NamedTuple

import numpy as np

Polygons = Sequence[Sequence[int]]


class Solid(NamedTuple):
    """Vertices, polygons whose corners are counted from 0, and what they enclose."""

    vertices: list[tuple[float, float, float]]
    polygons: list[list[int]]
    area: float
    volume: float


def prism(outline: list[tuple[float, float]], area: float, volume: float, start: int = 0) -> Solid:
    """An outline, counter-clockwise, drawn out to a height of 1: two caps of all its corners, and four corners a side.

    Corners of the outline that are equal are one vertex. The caps begin at the corner `start`.
    """
    points = list(dict.fromkeys(outline))
    count = len(points)
    ring = [points.index(corner) for corner in outline]
    turned = ring[start:] + ring[:start]
    sides = list(zip(ring, ring[1:] + ring[:1], strict=True))
    walls = [[a, b, b + count, a + count] for a, b in sides if (b, a) not in sides]
    vertices = [(float(x), float(y), z) for z in (0.0, 1.0) for x, y in points]
    return Solid(vertices, [[corner + count for corner in turned], turned[::-1], *walls], area, volume)


CUBE = prism([(0, 0), (1, 0), (1, 1), (0, 1)], 6, 1)
L = prism([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], 14, 3)
# as L, with a corner in the middle of each long side
L_STRAIGHT = prism([(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)], 14, 3)
U = prism([(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)], 30, 7)
# a square with a square hole, its outline going in and out by a cut
RING = prism([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], 48, 12)
TRIANGLES = Solid(CUBE.vertices, [t for a, b, c, d in CUBE.polygons for t in ([a, b, c], [a, c, d])], 6, 1)
MIXED = Solid(CUBE.vertices, [*CUBE.polygons[:3], *TRIANGLES.polygons[6:]], 6, 1)


def obj(
    solid: Solid, vertex: str = "v {} {} {}\n", face: str = "f {}\n", corner: str = "{0}", before: str = ""
) -> bytes:
    """A file in OBJ; a corner has its number counted from 1 as {0}, and from the end as {1}."""
    count = len(solid.vertices)
    rows = [vertex.format(*point) for point in solid.vertices]
    for polygon in solid.polygons:
        rows.append(face.format(" ".join(corner.format(index + 1, index - count) for index in polygon)))
    return (before + "".join(rows)).encode()


def ply(
    solid: Solid, order: str = "", number: str = "float", count: str = "uchar", index: str = "int", more: str = ""
) -> bytes:
    """A file in PLY: as text, or binary with the order "<" or ">"; with more lines at the end of its header."""
    letters = {"float": "f", "double": "d", "uchar": "B", "ushort": "H", "int": "i", "uint": "I", "char": "b"}
    form = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    header = (
        f"ply\nformat {form} 1.0\ncomment made by hand\nelement vertex {len(solid.vertices)}\n"
        + "".join(f"property {number} {axis}\n" for axis in "xyz")
        + f"element face {len(solid.polygons)}\nproperty list {count} {index} vertex_indices\n{more}end_header\n"
    ).encode()
    if not order:
        rows = [*solid.vertices, *([len(polygon), *polygon] for polygon in solid.polygons)]
        return header + "".join(" ".join(map(str, row)) + "\n" for row in rows).encode()
    body = b"".join(struct.pack(f"{order}3{letters[number]}", *point) for point in solid.vertices)
    for polygon in solid.polygons:
        body += struct.pack(f"{order}{letters[count]}{len(polygon)}{letters[index]}", len(polygon), *polygon)
    return header + body


def stl_text(solid: Solid, name: str = "cube") -> bytes:
    """A file in STL as text."""
    rows = [f"solid {name}\n"]
    for polygon in solid.polygons:
        rows.append("  facet normal 0 0 0\n    outer loop\n")
        rows += ["      vertex {:e} {:e} {:e}\n".format(*solid.vertices[corner]) for corner in polygon]
        rows.append("    endloop\n  endfacet\n")
    return "".join([*rows, f"endsolid {name}\n"]).encode("latin-1")


def stl_binary(solid: Solid, header: bytes = b"made by hand") -> bytes:
    """A file in binary STL."""
    content = header.ljust(80, b"\0") + struct.pack("<I", len(solid.polygons))
    for polygon in solid.polygons:
        points = [coordinate for corner in polygon for coordinate in solid.vertices[corner]]
        content += struct.pack("<12fH", 0, 0, 0, *points, 0)
    return content


def off(solid: Solid, first: str = "OFF\n{} {} 0\n", vertex: str = "{} {} {}\n", face: str = "{} {}\n") -> bytes:
    """A file in OFF."""
    rows = [first.format(len(solid.vertices), len(solid.polygons))]
    rows += [vertex.format(*point) for point in solid.vertices]
    rows += [face.format(len(polygon), " ".join(map(str, polygon))) for polygon in solid.polygons]
    return "".join(rows).encode()


def glb_document(solid: Solid, mode: int = 4, corners: list[int] | None = None) -> tuple[dict, bytes]:
    """The JSON and the data of a GLB file with one mesh at one node."""
    points = np.array(solid.vertices, "<f4").tobytes()
    faces = np.array(corners or solid.polygons, "<u2").reshape(-1)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(solid.vertices), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": len(faces), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": faces.nbytes},
        ],
        "buffers": [{"byteLength": len(points) + faces.nbytes}],
    }
    return document, points + faces.tobytes()


def glb(document: dict, data: bytes, version: int = 2) -> bytes:
    """A file in GLB."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", version, 12 + len(chunks)) + chunks


def changed(document_and_data: tuple[dict, bytes], path: str, value: object) -> bytes:
    """A GLB file with one entry of its JSON set, such as `nodes.0.scale`."""
    document, data = deepcopy(document_and_data)
    *above, last = path.split(".")
    place = document
    for key in above:
        place = place[int(key)] if isinstance(place, list) else place[key]
    place[int(last) if isinstance(place, list) else last] = value
    return glb(document, data)
