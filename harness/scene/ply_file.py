"""Writes meshes as binary PLY with vertices in double precision (trimesh would write single)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.whole_file import write_whole

HEADER = """ply
format binary_little_endian 1.0
element vertex {vertices}
property double x
property double y
property double z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def write_ply(path: Path, vertices: NDArray[np.float64], faces: NDArray[np.int32], replace: bool = False) -> None:
    """Write a mesh file.

    Parameters
    ----------
    path : of the file; folders above it are made
    vertices : (v, 3) float array
    faces : (f, 3) int array
    replace : whether a file that is there may be overwritten

    Raises
    ------
    FileExistsError
        If the file is there and may not be overwritten.
    OSError
        If it cannot be written.
    """
    rows = np.empty(len(faces), [("corners", "u1"), ("vertices", "<i4", 3)])
    rows["corners"] = 3
    rows["vertices"] = faces
    header = HEADER.format(vertices=len(vertices), faces=len(faces)).encode()
    write_whole(path, header + np.ascontiguousarray(vertices, "<f8").tobytes() + rows.tobytes(), replace=replace)
