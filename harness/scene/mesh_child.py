"""Reads mesh files in one child process with limits, so that a hostile or broken file costs only itself.

    python -m harness.scene.mesh_child FOLDER MEMORY TIMEOUT PATH...

The child writes a line of JSON on its standard output when it is ready and after each file; the arrays travel as .npz
files in a temporary folder, never as pickles.
"""

from __future__ import annotations

import json
import math
import os
import queue
import resource
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np

from harness.errors import InputError, Problem
from harness.scene.hull import Hull
from harness.scene.mesh import Mesh

GIB = 1024**3
# For the imports, on a machine with other things to do; nothing of a stranger's is read before.
START_SECONDS = 120.0


def open_meshes(paths: Sequence[Path], memory: int = 2 * GIB, timeout: float = 60.0) -> dict[Path, Mesh | str]:
    """Read mesh files in a child process.

    Parameters
    ----------
    paths : of the files
    memory : bytes the child may take beyond what its imports take
    timeout : seconds, CPU and elapsed, for each file

    Returns
    -------
    dict
        For each path its `Mesh`, or a sentence that says why there is none: what is wrong with the file, or that
        reading it took too much memory, took too long, or crashed.
    """
    results: dict[Path, Mesh | str] = {}
    waiting = list(dict.fromkeys(paths))
    while waiting:
        results |= _read_some(waiting, memory, timeout)
        waiting = [path for path in waiting if path not in results]
    return results


def open_all(paths: Iterable[Path]) -> dict[Path, Mesh]:
    """As `open_meshes`, but every mesh or none.

    Raises
    ------
    InputError
        With what is wrong with each of the others.
    """
    meshes, problems = {}, []
    for path, mesh in open_meshes(list(paths)).items():
        if isinstance(mesh, str):
            problems.append(Problem(mesh))
        else:
            meshes[path] = mesh
    if problems:
        raise InputError(problems)
    return meshes


def _read_some(paths: list[Path], memory: int, timeout: float) -> dict[Path, Mesh | str]:
    """One child's work, up to and with the file that ends it; at least the first."""
    results: dict[Path, Mesh | str] = {}
    with tempfile.TemporaryDirectory(prefix="harness-meshes-") as folder:
        command = [sys.executable, "-m", "harness.scene.mesh_child", folder, str(memory), str(timeout)]
        child = subprocess.Popen(
            command + [str(path.absolute()) for path in paths],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=folder,
            env=_environment(),
        )
        try:
            assert child.stdout is not None
            lines = _lines(child.stdout)
            limit = START_SECONDS
            lines.get(timeout=limit)
            limit = timeout
            for path in paths:
                line = lines.get(timeout=limit)
                if not line:
                    results[path] = _last_words(path, child.wait(), timeout)
                    break
                results[path] = _received(json.loads(line))
        except queue.Empty:
            results[paths[len(results)]] = _too_long(paths[len(results)], limit)
        finally:
            child.kill()
            child.wait()
    return results


def _environment() -> dict[str, str]:
    """The child's: this package found wherever the child starts, and no threads, whose stacks count as memory."""
    here = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(filter(None, [here, os.environ.get("PYTHONPATH")]))
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return os.environ | threads | {"PYTHONPATH": path}


def _lines(stream: IO[bytes]) -> queue.Queue[bytes]:
    """The lines of a stream, as they come; an empty one at its end, again and again."""
    lines: queue.Queue[bytes] = queue.Queue()

    def pump() -> None:
        with stream:
            for line in stream:
                lines.put(line)
        lines.put(b"")
        lines.put(b"")

    threading.Thread(target=pump, daemon=True).start()
    return lines


def _last_words(path: Path, code: int, timeout: float) -> str:
    """Why the child ended while it read a file."""
    if code == -signal.SIGXCPU:
        return _too_long(path, timeout)
    if code == -signal.SIGKILL:
        return f"{path.name}: reading it was killed (SIGKILL), as a system does that runs out of memory"
    if code < 0:
        return f"{path.name}: reading it crashed ({signal.Signals(-code).name})"
    return f"{path.name}: the reader ended without an answer (exit {code})"


def _too_long(path: Path, timeout: float) -> str:
    return f"{path.name}: reading it took longer than {timeout:g} s"


def _received(said: Mapping[str, Any]) -> Mesh | str:
    """What the child said of a file: a mesh, its arrays read-only, or a sentence."""
    if "error" in said:
        return str(said["error"])
    with np.load(said["file"], allow_pickle=False) as arrays:
        loaded = [arrays[name] for name in ("vertices", "faces", "hull_vertices", "hull_faces")]
    for array in loaded:
        array.setflags(write=False)
    vertices, faces, hull_vertices, hull_faces = loaded
    return Mesh(
        name=said["name"],
        vertices=vertices,
        faces=faces,
        hull=Hull(hull_vertices, hull_faces),
        digest=said["digest"],
        watertight=said["watertight"],
        convex=said["convex"],
        notes=tuple(said["notes"]),
        diameter=said["diameter"],
    )


def _serve(folder: Path, memory: int, timeout: float, paths: Sequence[Path]) -> None:
    """The child's side."""
    from harness.scene.mesh_file import read_mesh

    # The parsers may print; what they say must not look like ours.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _limit(resource.RLIMIT_AS, _address_space() + memory)
    print("{}", file=answers, flush=True)
    for place, path in enumerate(paths):
        used = resource.getrusage(resource.RUSAGE_SELF)
        _limit(resource.RLIMIT_CPU, math.ceil(used.ru_utime + used.ru_stime + timeout))
        try:
            answer = _sent(read_mesh(path), folder / f"{place}.npz")
        except InputError as error:
            answer = {"error": str(error)}
        except MemoryError:
            answer = {"error": f"{path.name}: reading it takes more than {memory / GIB:.3g} GiB of memory"}
        print(json.dumps(answer), file=answers, flush=True)


def _sent(mesh: Mesh, file: Path) -> dict[str, object]:
    """The answer for a mesh; its arrays are in the file then."""
    np.savez(
        file,
        vertices=mesh.vertices,
        faces=mesh.faces,
        hull_vertices=mesh.hull.vertices,
        hull_faces=mesh.hull.faces,
    )
    return {
        "file": str(file),
        "name": mesh.name,
        "digest": mesh.digest,
        "watertight": mesh.watertight,
        "convex": mesh.convex,
        "notes": mesh.notes,
        "diameter": mesh.diameter,
    }


def _limit(what: int, soft: int) -> None:
    """Lower a limit of this process, and leave the hard one, which could not be raised again."""
    _, hard = resource.getrlimit(what)
    resource.setrlimit(what, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))


def _address_space() -> int:
    """Bytes of address space this process has now, or 0 where the system does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except OSError:
        return 0
    return pages * resource.getpagesize()


if __name__ == "__main__":
    _serve(Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]), [Path(name) for name in sys.argv[4:]])
