"""Facts about experiment files kept between commands, so that a file that has not changed is not read again.

Facts are what a command says of one valid file, as JSON holds it. They hold as long as the text of the file, the
leaves that were set besides, this program and what is installed are the same, and as every mesh and all recorded poses
that the file names are found where they were, with the same content. What is wrong with a file is never kept.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from time import time
from typing import Any

from harness.errors import InputError
from harness.experiment.mesh_location import locate_mesh
from harness.installed import installed
from harness.kept_files import keep, kept

KIND = "facts"
_BEGAN = time()
# s by which a file's time of change may lag behind the clock, and more
_LAG = 0.1
_CHUNK = 2**20


def kept_facts(about: str, path: Path, overrides: Mapping[str, object]) -> dict[str, Any] | None:
    """What is kept of a file, if it still holds.

    Parameters
    ----------
    about : what the facts are about, the name of a command
    path, overrides : as the user gave them
    """
    try:
        text = path.read_bytes().decode("utf-8-sig")
        content = kept(KIND, _name(about, path, text, overrides))
        found = None if content is None else json.loads(content)
        if found is None or any(_named(path.parent, *name) != file for *name, file in found["files"]):
            return None
        facts: dict[str, Any] = found["facts"]
    except (OSError, ValueError, LookupError, TypeError):  # no file, no text, or a kept file that is none of ours
        return None
    return facts


def keep_facts(
    about: str,
    path: Path,
    overrides: Mapping[str, object],
    text: str,
    meshes: Mapping[str, Path],
    poses: Mapping[str, Path],
    facts: Mapping[str, Any],
) -> None:
    """Keep what a command found out about a file, unless something has changed while it ran.

    Parameters
    ----------
    about, path, overrides : as for `kept_facts`
    text : of the file, as it was read
    meshes, poses : by the names in the file, those that it refers to
    facts : as JSON holds them
    """
    with suppress(OSError):
        if any(file.stat().st_mtime > _BEGAN - _LAG for file in (*meshes.values(), *poses.values())):
            return
        names = [*(("mesh", name) for name in meshes), *(("poses", name) for name in poses)]
        files = [[kind, name, _named(path.parent, kind, name)] for kind, name in names]
        content = json.dumps({"files": files, "facts": facts})
        keep(KIND, _name(about, path, text, overrides), content.encode())


def _name(about: str, path: Path, text: str, overrides: Mapping[str, object]) -> str:
    given = [[leaf, repr(value)] for leaf, value in overrides.items()]
    key = json.dumps([installed(), about, str(path), os.path.abspath(path), text, given])
    return f"{hashlib.sha256(key.encode('utf-8', 'surrogatepass')).hexdigest()[:40]}.json"


def _named(folder: Path, kind: str, name: str) -> list[str] | None:
    """The file that a name means now, and a hash of its content; None if there is none."""
    try:
        file = locate_mesh(name, folder) if kind == "mesh" else (folder / name).resolve()
    except InputError:
        return None
    now = file.stat()
    return [str(file), _digest(file, now.st_mtime_ns, now.st_size)]


@lru_cache(maxsize=256)
def _digest(file: Path, changed: int, size: int) -> str:
    """Of many experiments that name a mesh, the first has it read."""
    content = hashlib.sha256()
    with file.open("rb") as stream:
        while part := stream.read(_CHUNK):
            content.update(part)
    return content.hexdigest()
