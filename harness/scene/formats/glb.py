"""GLB: the triangles of a binary glTF 2.0 file's scene, each mesh placed by its nodes.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html. Points and lines are passed over, as are materials, textures,
skins and morph targets. What would change the shape and is not read is refused: compression, sparse or normalised data,
triangle fans, and data outside of the file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.polygon_mesh import MAX_FACES, PolygonMesh

# How such a file begins.
BEGINS = rb"glTF[\x01\x02]\0\0\0"
JSON, BINARY = b"JSON", b"BIN\0"
TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WHOLE = {5121, 5123, 5125}  # the types of corners
WIDTHS = {"SCALAR": 1, "VEC3": 3}
TRIANGLES, STRIP, FAN = 4, 5, 6
COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")


class Part(NamedTuple):
    """Triangles of one primitive, placed: (v, 3) float vertices and (f, 3) int faces."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]


def read(content: bytes) -> PolygonMesh:
    """The triangles of a GLB file.

    Raises
    ------
    InputError
        If it is no GLB file, ends too early, contradicts itself, or holds what is not read.
    """
    document, data = _chunks(content)
    try:
        parts = _parts(document, data)
    except (AttributeError, IndexError, KeyError, OverflowError, RecursionError, TypeError, ValueError) as error:
        raise InputError("its JSON chunk contradicts itself, its data or the glTF specification") from error
    faces = [part.faces for part in parts]
    before = np.cumsum([0, *(len(part.vertices) for part in parts)])
    if not faces:
        raise InputError("the mesh is empty: it has no faces in its scene")
    corners = np.concatenate([face.reshape(-1) + start for face, start in zip(faces, before, strict=False)])
    vertices = np.concatenate([part.vertices for part in parts])
    return PolygonMesh(vertices, corners, np.full(len(corners) // 3, 3))


def _chunks(content: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON of the file, and the bytes that it describes."""
    if content[:4] != b"glTF":
        raise InputError("this is no GLB file: it does not begin with glTF")
    version, length = (int.from_bytes(content[start : start + 4], "little") for start in (4, 8))
    if version != 2:
        raise InputError(f"its version of glTF is {version}; only 2 is read")
    if length > len(content):
        raise InputError(f"the file ends after {len(content)} of {length} bytes")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = int.from_bytes(content[place : place + 4], "little"), content[place + 4 : place + 8]
        if place + 8 + size > length:
            raise InputError(f"the file ends in its chunk {kind.decode('ascii', 'replace').strip(chr(0))}")
        chunks.setdefault(kind, content[place + 8 : place + 8 + size])
        place += 8 + size
    try:
        document = json.loads(chunks.get(JSON, b""))
    except (ValueError, RecursionError) as error:
        raise InputError("its JSON chunk is missing or is no JSON") from error
    if not isinstance(document, dict):
        raise InputError("its JSON chunk describes no scene")
    return document, chunks.get(BINARY, b"")


def _parts(document: dict[str, Any], data: bytes) -> list[Part]:
    """The triangles of the scene."""
    used = (*document.get("extensionsRequired", ()), *document.get("extensionsUsed", ()))
    for extension in COMPRESSED:
        if extension in used:
            raise InputError(f"its data are compressed ({extension}), which is not read")
    parts, count = [], 0
    for mesh, placed in _placed(document):
        for primitive in mesh["primitives"]:
            mode = primitive.get("mode", TRIANGLES)
            if mode == FAN:
                raise InputError("it has triangle fans, which are not read")
            if mode not in (TRIANGLES, STRIP):
                continue
            vertices = _numbers(document, data, primitive["attributes"]["POSITION"], "VEC3", set(TYPES))
            if "indices" in primitive:
                corners = _numbers(document, data, primitive["indices"], "SCALAR", WHOLE).reshape(-1).astype(np.int64)
            else:
                corners = np.arange(len(vertices))
            faces = _strip(corners) if mode == STRIP else corners.reshape(-1, 3)
            count += len(faces)
            if count > MAX_FACES:
                raise InputError(f"its scene has more than {MAX_FACES} faces, which is the most that is read")
            if len(faces) and not 0 <= faces.min() <= faces.max() < len(vertices):
                raise InputError(f"a face names vertex {faces.max()} of {len(vertices)}")
            points = np.column_stack([vertices.astype(np.float64), np.ones(len(vertices))])
            parts.append(Part(np.ascontiguousarray((placed @ points.T).T[:, :3]), faces))
    return parts


def _placed(document: dict[str, Any]) -> Iterator[tuple[dict[str, Any], NDArray[np.float64]]]:
    """Each mesh of the scene with the 4×4 matrix that places it; a node stands in one place."""
    nodes = document.get("nodes", [])
    scenes = document.get("scenes", [])
    roots = _at(scenes, document.get("scene", 0)).get("nodes", []) if scenes else range(len(nodes))
    waiting = [(root, np.eye(4)) for root in reversed(roots)]
    seen: set[int] = set()
    while waiting:
        name, above = waiting.pop()
        node = _at(nodes, name)
        if name in seen:
            raise InputError(f"its node {name} stands in two places of the scene")
        seen.add(name)
        here = above @ _matrix(node)
        if "mesh" in node:
            yield _at(document["meshes"], node["mesh"]), here
        waiting += [(child, here) for child in reversed(node.get("children", []))]


def _matrix(node: dict[str, Any]) -> NDArray[np.float64]:
    """The 4×4 matrix of a node within the one above it."""
    if "matrix" in node:
        return np.asarray(np.array(node["matrix"], np.float64).reshape(4, 4).T)
    matrix = np.eye(4)
    quaternion = np.array(node.get("rotation", (0, 0, 0, 1)), np.float64).reshape(4)
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    scale = np.array(node.get("scale", (1, 1, 1)), np.float64).reshape(3)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix[:3, :3] = turn * scale
    matrix[:3, 3] = np.array(node.get("translation", (0, 0, 0)), np.float64).reshape(3)
    return matrix


def _numbers(document: dict[str, Any], data: bytes, index: int, form: str, types: set[int]) -> NDArray[Any]:
    """(count, width) array of an accessor."""
    accessor = _at(document["accessors"], index)
    for word in ("sparse", "normalized"):
        if accessor.get(word):
            raise InputError(f"its accessor {index} is {word}, which is not read")
    if accessor["componentType"] not in types or accessor["type"] != form:
        raise InputError(f"its accessor {index} is of a type that is not read there")
    view = _at(document["bufferViews"], accessor["bufferView"])
    if view["buffer"] != 0 or "uri" in _at(document["buffers"], 0):
        raise InputError("its data stand outside of its binary chunk, which is not read")
    kind, count, width = np.dtype(TYPES[accessor["componentType"]]), accessor["count"], WIDTHS[form]
    stride = view.get("byteStride", kind.itemsize * width)
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    if min(start, count) < 0 or stride < kind.itemsize * width:
        raise InputError(f"its accessor {index} has impossible offsets")
    if count and start + stride * (count - 1) + kind.itemsize * width > len(data):
        raise InputError(f"the file ends in the data of accessor {index}")
    numbers: NDArray[Any] = np.ndarray((count, width), kind, data, start, (stride, kind.itemsize))
    return numbers


def _strip(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """The triangles of a strip; every second one is turned."""
    faces = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    faces[1::2] = faces[1::2][:, [1, 0, 2]]
    return np.asarray(faces)


def _at(rows: list[dict[str, Any]], index: int) -> dict[str, Any]:
    """A row by its number, which must not be negative."""
    if index < 0:
        raise IndexError(index)
    return rows[index]
