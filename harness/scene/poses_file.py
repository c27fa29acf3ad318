"""Reads poses that another program has recorded: a NumPy archive of three arrays, none of them of Python objects."""

from __future__ import annotations

import lzma
import math
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.recorded_poses import RecordedPoses, digest_of

# B that a file may have, and that its arrays may need when they are unpacked.
LARGEST = 256 * 2**20
# m and s, as for the numbers of an experiment: squares and cubes of what lies beyond would overflow or underflow.
_FARTHEST, _SHORTEST = 1e30, 1e-30
# By how much the length of a quaternion may be off 1: single precision leaves 1e-7.
_OFF = 1e-6
# What comes of a header that is no Python text of a dictionary as NumPy writes it.
_UNREADABLE = (ValueError, KeyError, TypeError, SyntaxError, tokenize.TokenError, OverflowError, RecursionError)

_SHAPES = {"time": "(f,)", "positions": "(f, n, 3)", "quaternions": "(f, n, 4)"}


def read_poses(path: Path) -> RecordedPoses:
    """Read a file of poses.

    Parameters
    ----------
    path : of an .npz file with `time` (f,) s, `positions` (f, n, 3) m and `quaternions` (f, n, 4) w x y z

    Raises
    ------
    InputError
        If it is too large, damaged, or not what poses are.
    """
    arrays = {name: _real(path, name, array) for name, array in _arrays(path).items()}
    time, positions, quaternions = arrays["time"], arrays["positions"], arrays["quaternions"]
    _require_shapes(path, time, positions, quaternions)
    for name, array in arrays.items():
        if not np.isfinite(array).all():
            frame = int(np.argmin(np.isfinite(array.reshape(len(array), -1)).all(axis=1)))
            raise InputError(f"{path.name}: {name}[{frame}] has a value that is not finite")
        if name != "quaternions" and np.abs(array).max() > _FARTHEST:
            raise InputError(f"{path.name}: {name} must be within {_FARTHEST:g}, not {np.abs(array).max():g}")
    later = np.diff(time) >= _SHORTEST
    if not later.all():
        frame = int(np.argmin(later))
        raise InputError(
            f"{path.name}: times must grow; time[{frame + 1}] is {time[frame + 1]:g} after {time[frame]:g}, "
            f"and must be {_SHORTEST:g} s later at least"
        )
    with np.errstate(over="ignore"):  # an infinite length is refused as any other
        lengths = np.linalg.norm(quaternions, axis=2)
    if (np.abs(lengths - 1.0) > _OFF).any():
        worst, body = np.unravel_index(int(np.argmax(np.abs(lengths - 1.0))), lengths.shape)
        length = lengths[worst, body]
        raise InputError(
            f"{path.name}: quaternions[{worst}, {body}] has length {length:.9g}; it must be 1, within 1e-6"
        )
    quaternions = quaternions / lengths[:, :, None]
    return RecordedPoses(path.name, time, positions, quaternions, digest_of(time, positions, quaternions))


def _arrays(path: Path) -> dict[str, NDArray[np.generic]]:
    """The three arrays as they are, none of which is larger than it may be."""
    size = path.stat().st_size
    if size > LARGEST:
        raise InputError(f"{path.name}: {size / 2**20:.0f} MiB are too large; poses may have {LARGEST // 2**20} MiB")
    if not zipfile.is_zipfile(path):
        raise InputError(f"{path.name}: this is no .npz file, or it is cut short; numpy.savez writes one")
    try:
        with zipfile.ZipFile(path) as archive:
            found = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
            lacking = [name for name in _SHAPES if name not in found]
            if lacking:
                has = _printable(", ".join(list(found)[:10])) or "nothing"
                raise InputError(
                    f"{path.name}: there is no array {lacking[0]} {_SHAPES[lacking[0]]} in it; it has {has}"
                )
            unpacked = sum(found[name].file_size for name in _SHAPES)
            if unpacked > LARGEST:
                much = f"{unpacked / 2**20:.0f} MiB"
                raise InputError(f"{path.name}: {much} unpacked are too large; poses may have {LARGEST // 2**20} MiB")
            return {name: _array(path, name, archive, found[name]) for name in _SHAPES}
    except RuntimeError as error:  # what zipfile says of a member with a password
        raise InputError(f"{path.name}: it is encrypted; write it without a password") from error
    except OSError as error:
        raise InputError(f"{path.name}: it cannot be read: {error.strerror or 'damaged or cut short'}") from error
    except (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, ValueError) as error:
        raise InputError(f"{path.name}: it is damaged or cut short") from error


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in text)


def _array(path: Path, name: str, archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[np.generic]:
    """One array. Nothing is made of its size before its file is known to hold as much."""
    try:
        file = archive.open(member)
    except NotImplementedError:
        raise InputError(
            f"{path.name}: {name} is compressed in a way that is not read; numpy.savez writes one"
        ) from None
    with file:
        shape, fortran, dtype = _header(path, name, file)
        if dtype.hasobject:
            raise InputError(f"{path.name}: it holds pickled Python objects, which are not read")
        size = math.prod(shape) * dtype.itemsize
        content = file.read(min(size, LARGEST))
    if len(content) < size:
        raise InputError(f"{path.name}: {name} is cut short: {len(content)} bytes of data for the shape {shape}")
    return np.frombuffer(content, dtype).reshape(shape, order="F" if fortran else "C")


def _header(path: Path, name: str, file: Any) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, whether the first index varies fastest, and kind of number, as NumPy's format has them before the data."""
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    try:
        shape, fortran, dtype = readers[np.lib.format.read_magic(file)](file)
    except (*_UNREADABLE, MemoryError) as error:  # the parser of Python says MemoryError of what is nested too deeply
        raise InputError(f"{path.name}: {name} does not begin like an array that NumPy has written") from error
    if any(length < 0 for length in shape):
        raise InputError(f"{path.name}: {name} cannot have the shape {shape}")
    return shape, fortran, dtype


def _real(path: Path, name: str, array: NDArray[np.generic]) -> NDArray[np.float64]:
    if array.dtype.kind not in "fiu":
        raise InputError(f"{path.name}: {name} must hold real numbers, not {array.dtype}")
    with np.errstate(over="ignore"):  # what a longer number has beyond a float is infinite, and refused
        return np.ascontiguousarray(array, np.float64)


def _require_shapes(
    path: Path, time: NDArray[np.float64], positions: NDArray[np.float64], quaternions: NDArray[np.float64]
) -> None:
    for name, array, dimensions in (("time", time, 1), ("positions", positions, 3), ("quaternions", quaternions, 3)):
        if array.ndim != dimensions:
            raise InputError(f"{path.name}: {name} must have the shape {_SHAPES[name]}, not {array.shape}")
    frames = len(time)
    if frames < 2:
        raise InputError(f"{path.name}: there must be two times at least, the start and a frame; there are {frames}")
    bodies = positions.shape[1]
    if bodies < 1:
        raise InputError(f"{path.name}: positions are of no body")
    for name, array, last in (("positions", positions, 3), ("quaternions", quaternions, 4)):
        if array.shape != (frames, bodies, last):
            needed = (frames, bodies, last)
            raise InputError(
                f"{path.name}: {name} must have the shape {needed} like the other arrays, not {array.shape}"
            )
