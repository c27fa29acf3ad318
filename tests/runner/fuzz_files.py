"""Recorded poses and sets of cases, damaged at random and deep inside: each is read or refused in a person's words.

    python tests/runner/fuzz_files.py [TRIES]

Arrays of other types and shapes, names that are missing, numbers that are none or too large, files that are cut; each
within ten seconds. What is read of a set is asked for its first bounds as `harness truth check` asks. Prints what came
of each kind, and every file with which something went wrong.
"""

from __future__ import annotations

import io
import random
import re
import signal
import sys
import tempfile
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.scene.poses_file import read_poses
from harness.truth.folder import COLUMNS, read_set
from tests.scene.fuzz_meshes import INNER, changed

SECONDS = 10
CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + (
    "f 1 2 4\nf 1 4 3\nf 5 7 8\nf 5 8 6\nf 1 5 6\nf 1 6 2\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8\nf 2 8 4\n"
)
PYTHONS = re.compile(r"could not convert|invalid literal|codec|reshape|inhomogeneous|embedded")
ODD_WORDS = (
    "",
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "1e-320",
    "1e400",
    "9" * 400,
    "1_0",
    "x",
    "mesh",
    "../cube",
    "\0",
    "1,5",
)
KINDS = ("f8", "f4", "f2", "i8", "u1", "i2", "c16", "?", "S3", "U2", "M8[s]", "V5", "g", ">f8", "(2,)f4", "i4,f8")


def poses(chance: random.Random) -> dict[str, np.ndarray]:
    """Three arrays as they should be, but for one that is odd in one way."""
    arrays = {
        "time": np.arange(4.0),
        "positions": np.arange(24.0).reshape(4, 2, 3),
        "quaternions": np.tile([1.0, 0, 0, 0], (4, 2, 1)),
    }
    name = chance.choice(list(arrays))
    array = arrays[name]
    match chance.randrange(7):
        case 0:
            del arrays[name]
        case 1:
            with np.errstate(all="ignore"):
                kind = np.dtype(chance.choice(KINDS))
                arrays[name] = np.zeros(array.shape, kind) if kind.names or kind.shape else array.astype(kind)
        case 2:
            shape = list(array.shape)
            shape[chance.randrange(len(shape))] = chance.choice((0, 1, 2, 5))
            arrays[name] = np.resize(array, shape)
        case 3:
            arrays[name] = array.reshape(chance.choice(((-1,), (1, -1), (-1, 1, 1, 1))))
        case 4:
            array.reshape(-1)[chance.randrange(array.size)] = chance.choice(
                (np.nan, np.inf, -np.inf, 1e308, -1e308, 1e-320, 1e31, -1.0, 0.5)
            )
        case 5:
            arrays[name] = np.array(chance.choice((0.0, None, "x", [[1], [2, 3]] and 1j, 2**63)))
        case _:
            arrays["more"] = array
    return arrays


def damaged_poses(folder: Path, chance: random.Random) -> Callable[[], object]:
    """A file of poses that is odd, or whose bytes are."""
    buffer = io.BytesIO()
    save = np.savez_compressed if chance.random() < 0.3 else np.savez
    save(buffer, **poses(chance))  # type: ignore[arg-type]
    content = buffer.getvalue()
    where = chance.random()
    if where < 0.3:
        content = changed(content, chance, [content])
    elif where < 0.6:  # the arrays' own bytes, in an archive that is sound
        members = zipfile.ZipFile(io.BytesIO(content))
        parts = {info.filename: members.read(info) for info in members.infolist()}
        name = chance.choice(list(parts))
        parts[name] = changed(parts[name], chance, list(parts.values()))
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:
            for part, value in parts.items():
                archive.writestr(part, value)
        content = buffer.getvalue()
    path = folder / "a.npz"
    path.write_bytes(content)
    return lambda: read_poses(path)


def damaged_set(folder: Path, chance: random.Random) -> Callable[[], object]:
    """A set of cases with a table or a mesh that is odd."""
    row = ["random", "mesh", "cube", "1", *"000", *"1000", *"100", *"000"]
    row += ["cube", "1", *"300", *"1000", "-1", *"00", *"000", "10", "0.5", "1", "touches"]
    rows = [list(COLUMNS), list(row), ["random", "sphere", "", *row[3:17], "", *row[18:]]]
    for _ in range(chance.choice((0, 1, 1, 2))):
        chance.choice(rows[1:])[chance.randrange(len(row))] = chance.choice(ODD_WORDS)
    table = "".join(",".join(one) + "\n" for one in rows).encode()
    mesh = CUBE.encode()
    if chance.random() < 0.4:
        table = changed(table, chance, [table])
    if chance.random() < 0.5:
        mesh = changed(mesh, chance, [mesh])
    (folder / "meshes").mkdir(exist_ok=True)
    (folder / "cases.csv").write_bytes(table)
    (folder / "meshes" / "cube.obj").write_bytes(mesh)

    def read() -> object:
        from harness.truth.check import check

        return check(read_set(folder), lambda _: None)

    return read


def fuzz(
    make: Callable[[Path, random.Random], Callable[[], object]], tries: int, seed: int = 0
) -> tuple[Counter[str], list[str]]:
    """So many files of a kind: what came of them, and what went wrong."""
    chance, outcomes, failures = random.Random(seed), Counter[str](), list[str]()
    signal.signal(signal.SIGALRM, _too_long)
    warnings.simplefilter("error")  # as PYTHONWARNINGS=error has it
    for number in range(tries):
        with tempfile.TemporaryDirectory() as name:
            read = make(Path(name), chance)
            signal.alarm(SECONDS)
            try:
                read()
                outcomes["read"] += 1
            except InputError as error:
                said = "\n".join(map(str, error.problems)).replace(name, "")
                outcomes["refused"] += 1
                if INNER.search(said) or PYTHONS.search(said) or not said.replace("\n", "").isprintable():
                    failures.append(f"{number}: {said}")
            except BaseException as error:
                outcomes["went wrong"] += 1
                failures.append(f"{number}: {type(error).__name__}: {error}")
            finally:
                signal.alarm(0)
    return outcomes, failures


def _too_long(number: int, frame: object) -> None:
    raise TimeoutError(f"it took longer than {SECONDS} s")


KINDS_OF_FILES = {"poses": damaged_poses, "sets of cases": damaged_set}


def main(tries: int, seed: int) -> int:
    """Fuzz both kinds; returns 1 if anything went wrong."""
    wrong = 0
    for name, make in KINDS_OF_FILES.items():
        outcomes, failures = fuzz(make, tries, seed)
        wrong += len(failures)
        print(f"{name}: {dict(outcomes)}, {len(failures)} not right")
        for said in failures[:40]:
            print(f"  {said[:300]}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000, int(sys.argv[2]) if len(sys.argv) > 2 else 0))
