"""Reads meshes and recorded poses in one child process with limits: a hostile or broken file costs only itself.

    python -m harness.scene.mesh_child FD FOLDER MEMORY TIMEOUT MESHES PATH...

The first MESHES of the paths are meshes, the others recorded poses. The child sends JSON through the socket FD when it
is ready and after each file; the arrays travel as .npz files in a temporary folder, never as pickles.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.errors import InputError, Problem
from harness.process_limits import isolate, limit
from harness.scene.mesh import Mesh
from harness.scene.mesh_cache import arrays_of, facts_of, keep_mesh, kept_mesh, key_of, mesh_of
from harness.scene.recorded_poses import RecordedPoses

if TYPE_CHECKING:
    from harness.child_process import Channel, Ending

GIB = 1024**3
# For the imports, on a machine with other things to do; no file that is not trusted is read before.
START_SECONDS = 120.0


def open_meshes(paths: Sequence[Path], memory: int = 2 * GIB, timeout: float = 60.0) -> dict[Path, Mesh | str]:
    """Read mesh files in a child process; as `open_files`."""
    found = open_files(paths, (), memory, timeout)
    return {path: part for path, part in found.items() if not isinstance(part, RecordedPoses)}


def open_files(
    meshes: Sequence[Path], poses: Sequence[Path], memory: int = 2 * GIB, timeout: float = 60.0
) -> dict[Path, Mesh | RecordedPoses | str]:
    """Read files in a child process, but for meshes that were read before and are kept.

    Parameters
    ----------
    meshes, poses : of the files
    memory : bytes the child may take beyond what its imports take
    timeout : seconds, CPU and elapsed, for each file

    Returns
    -------
    dict
        For each path its `Mesh` or `RecordedPoses`, or a sentence that says why there is none: what is wrong with the
        file, or that reading it took too much memory, took too long, or crashed.
    """
    keys = {path: key_of(path) for path in meshes}
    kept = {path: kept_mesh(key) for path, key in keys.items() if key is not None}
    results: dict[Path, Mesh | RecordedPoses | str] = {path: mesh for path, mesh in kept.items() if mesh is not None}
    while True:
        waiting = [[path for path in dict.fromkeys(paths) if path not in results] for paths in (meshes, poses)]
        if not any(waiting):
            break
        results |= _read_some(waiting[0], waiting[1], memory, timeout)
    for path, key in keys.items():
        mesh = results[path]
        # a file that has changed meanwhile is not what the key says
        if key is not None and kept[path] is None and isinstance(mesh, Mesh) and key_of(path) == key:
            keep_mesh(key, mesh)
    return {path: results[path] for path in dict.fromkeys((*meshes, *poses))}


def open_all(meshes: Iterable[Path], poses: Iterable[Path] = ()) -> dict[Path, Mesh | RecordedPoses]:
    """As `open_files`, but every file or none.

    Raises
    ------
    InputError
        With what is wrong with each of the others.
    """
    opened, problems = {}, []
    for path, part in open_files(list(meshes), list(poses)).items():
        if isinstance(part, str):
            problems.append(Problem(part))
        else:
            opened[path] = part
    if problems:
        raise InputError(problems)
    return opened


def _read_some(
    meshes: list[Path], poses: list[Path], memory: int, timeout: float
) -> dict[Path, Mesh | RecordedPoses | str]:
    """One child's work, up to and with the file that ends it; at least the first."""
    from harness.child_process import Child  # only where something is to be read

    results: dict[Path, Mesh | RecordedPoses | str] = {}
    paths = [*meshes, *poses]
    with tempfile.TemporaryDirectory(prefix="harness-meshes-") as folder:
        arguments = [folder, str(memory), str(timeout), str(len(meshes)), *(str(path.absolute()) for path in paths)]
        with Child.spawn("harness.scene.mesh_child", arguments, _environment(), folder) as child:
            seconds = START_SECONDS
            answer = child.receive(seconds)
            for path in paths:
                if isinstance(answer, bytes):
                    seconds = timeout
                    answer = child.receive(seconds)
                if not isinstance(answer, bytes):
                    late = answer == "timeout"
                    results[path] = _too_long(path, seconds) if late else _why_it_ended(path, child.end(), timeout)
                    break
                results[path] = _received(json.loads(answer))
    return results


def _environment() -> dict[str, str]:
    """The child's: this package found wherever the child starts, and no threads, whose stacks count as memory."""
    here = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(filter(None, [here, os.environ.get("PYTHONPATH")]))
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return os.environ | threads | {"PYTHONPATH": path}


def _why_it_ended(path: Path, ending: Ending, timeout: float) -> str:
    """Why the child ended while it read a file."""
    if ending.signal == signal.SIGXCPU:
        return _too_long(path, timeout)
    if ending.killed:
        return f"{path.name}: reading it was killed (SIGKILL), as a system does that runs out of memory"
    if ending.signal:
        return f"{path.name}: reading it crashed ({ending.signal_name})"
    return f"{path.name}: the reader ended without an answer (exit {ending.code})"


def _too_long(path: Path, timeout: float) -> str:
    return f"{path.name}: reading it took longer than {timeout:g} s"


def _received(said: Mapping[str, Any]) -> Mesh | RecordedPoses | str:
    """What the child said of a file: a mesh or poses, the arrays read-only, or a sentence."""
    if "error" in said:
        return str(said["error"])
    with np.load(said["file"], allow_pickle=False) as arrays:
        loaded = [arrays[name] for name in arrays.files]
    if not said["poses"]:
        return mesh_of(said, loaded)
    for array in loaded:
        array.setflags(write=False)
    time, positions, quaternions = loaded
    return RecordedPoses(said["name"], time, positions, quaternions, said["digest"])


def _serve(answers: Channel, folder: Path, memory: int, timeout: float, meshes: int, paths: Sequence[Path]) -> None:
    """The child's side."""
    import scipy.spatial  # noqa: F401  # which the first hull would load, within the limits of its file

    from harness.scene.mesh_file import read_mesh
    from harness.scene.poses_file import read_poses

    limit(memory=memory)
    answers.send(b"{}")
    for place, path in enumerate(paths):
        limit(cpu=timeout)
        try:
            part = read_mesh(path) if place < meshes else read_poses(path)
            answer = _sent(part, folder / f"{place}.npz")
        except InputError as error:
            answer = {"error": str(error)}
        except MemoryError:
            answer = {"error": f"{path.name}: reading it takes more than {memory / GIB:.3g} GiB of memory"}
        except OSError as error:
            why = f"what was read of it cannot be put into {folder}: {error.strerror}"
            answer = {"error": f"{path.name}: {why}. Make room there, or name another folder by TMPDIR"}
        answers.send(json.dumps(answer).encode())


def _sent(part: Mesh | RecordedPoses, file: Path) -> dict[str, object]:
    """The answer for a mesh or for poses; the arrays are in the file then."""
    if isinstance(part, RecordedPoses):
        np.savez(file, part.time, part.positions, part.quaternions)
        return {"file": str(file), "poses": True, "name": part.name, "digest": part.digest}
    np.savez(file, *arrays_of(part))
    return {"file": str(file), "poses": False, **facts_of(part)}


if __name__ == "__main__":
    from harness.child_process import Channel

    isolate()
    _serve(
        Channel(int(sys.argv[1])),
        Path(sys.argv[2]),
        int(sys.argv[3]),
        float(sys.argv[4]),
        int(sys.argv[5]),
        [*map(Path, sys.argv[6:])],
    )
