"""How fast the kernels of the working tree are, against those of another commit: a table, never a failure.

    .venv/bin/python .ci/kernel_times.py [--base REV] [--rounds N] [--seconds S]

Each row is a small experiment whose measured clock runs in one kernel. Both sides sweep all of them, each with its own
sources and in processes of its own, and take turns. A ratio is of CPU times of one turn, so that whatever else the
machine does meanwhile slows both down alike; the first turn compiles, and does not count. To compare changes that are
not committed yet, give `--base HEAD`.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import subprocess
import sys
import tarfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any, NamedTuple

HERE = Path(__file__).resolve().parent.parent
REPEATS = 3  # of a row in a turn, of which the median counts
TIMEOUT = 600  # s, of one command
PUMPKIN = "pumpkin-1753.ply"


class Row(NamedTuple):
    """A kernel, and the experiment that measures it.

    scene, motion, engine : as in an experiment's file
    metric : the clock that counts
    """

    scene: dict[str, Any]
    motion: dict[str, Any]
    engine: dict[str, Any]
    metric: str = "pair_seconds"

    def document(self, name: str) -> dict[str, Any]:
        """The experiment; JSON is YAML."""
        return {
            "title": name,
            "scene": self.scene,
            "motion": self.motion,
            "engine": self.engine,
            "measure": {"repeats": REPEATS},
        }


def _scene(shape: str, count: int, side: float, **more: Any) -> dict[str, Any]:
    mesh = {} if shape == "sphere" else {"mesh": PUMPKIN}
    return {"shape": shape, "count": count, "box": [side, side, side], **mesh, **more}


FRAMES = {"duration": 1, "dt": 0.05, "response": "none"}
GRID, PREDICTIVE = {"algorithm": "grid"}, {"algorithm": "predictive"}

ROWS = {
    "grid, close pairs": Row(_scene("sphere", 20_000, 47.0), FRAMES, GRID),
    "hulls, pairs": Row(_scene("hull", 1000, 14.0), FRAMES, GRID),
    "hulls, pairs by GJK alone": Row(_scene("hull", 500, 11.0), FRAMES, GRID | {"stages": {"hull_axis": False}}),
    "meshes, pairs": Row(_scene("mesh", 300, 9.0), FRAMES, GRID),
    "walls": Row(
        _scene("hull", 1000, 22.0),
        {"duration": 1, "dt": 0.05},
        GRID | {"stages": {"wall_cull": False}},
        metric="box_seconds",
    ),
    "predictive, spheres in cells": Row(
        _scene("sphere", 2000, 17.0), {"duration": 20, "response": "elastic"}, PREDICTIVE, "run_seconds"
    ),
    "predictive, spheres in lists": Row(
        _scene("sphere", 2000, 13.2, overlap="allow"),
        {"duration": 4, "response": "elastic"},
        PREDICTIVE,
        "run_seconds",
    ),
    "predictive, hulls": Row(
        _scene("hull", 300, 12.0), {"duration": 10, "response": "elastic"}, PREDICTIVE, "run_seconds"
    ),
    "predictive, meshes": Row(
        _scene("mesh", 100, 8.0), {"duration": 4, "response": "elastic"}, PREDICTIVE, "run_seconds"
    ),
}


class Side:
    """One version of the sources, and what its turns have measured.

    Parameters
    ----------
    tree : where the sources are
    scratch : a folder for the experiments and databases of this side
    """

    def __init__(self, tree: Path, scratch: Path) -> None:
        self.tree, self.scratch = tree, scratch
        self.missing: dict[str, str] = {}  # rows that it cannot run, with the reason
        self.files: dict[str, Path] = {}
        self.turns = 0
        scratch.mkdir()
        for number, (name, row) in enumerate(ROWS.items()):
            self.files[name] = scratch / f"{number}.yaml"
            self.files[name].write_text(json.dumps(row.document(name)))

    def turn(self) -> dict[str, float]:
        """CPU seconds of each row that can be run, once more."""
        self.turns += 1
        database = self.scratch / f"{self.turns}.db"
        ended = self._sweep(database)
        if ended.returncode == 2:  # a file that this side does not understand stops them all
            for name in list(self.files):
                checked = self._harness(["validate", str(self.files[name])])
                if checked.returncode:
                    self._drop(name, checked.stderr)
            ended = self._sweep(database)
        if not database.exists():
            raise RuntimeError(f"{self.tree}: {ended.stderr.strip()}")
        exported = self._harness(["export", "--db", str(database), "--format", "json"])
        measured: dict[str, list[float]] = {}
        for run in json.loads(exported.stdout)["runs"]:
            name = next(name for name, file in self.files.items() if Path(run["experiment"]).stem == file.stem)
            if run["status"] != "ok" or ROWS[name].metric not in run["metrics"]:
                self.missing.setdefault(name, run["reason"] or f"no {ROWS[name].metric}")
            else:
                measured.setdefault(name, []).append(run["metrics"][ROWS[name].metric])
        return {name: median(times) for name, times in measured.items()}

    def _drop(self, name: str, why: str) -> None:
        self.missing[name] = why.strip().splitlines()[0] if why.strip() else "not there"
        del self.files[name]

    def _sweep(self, database: Path) -> subprocess.CompletedProcess[str]:
        files = [str(file) for file in self.files.values()]
        return self._harness(["sweep", "--quiet", "--db", str(database), *files])

    def _harness(self, command: list[str]) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "harness", *command],
            cwd=self.tree,
            env=os.environ | {"PYTHONPATH": str(self.tree)},
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )


def main() -> None:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", default="HEAD~1", metavar="REV", help="what to compare with (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="turns of each side, at most (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=90.0, help="after which no turn begins (default: %(default)s)")
    options = parser.parse_args()
    if not _git("diff", "--name-only", options.base, "--", "harness"):
        print(f"harness/ is as it was at {options.base}: there is no kernel to compare.")
        return
    began = monotonic()
    with TemporaryDirectory(prefix="kernel-times-") as folder:
        base = Path(folder, "base")
        with tarfile.open(fileobj=io.BytesIO(_git("archive", options.base, "harness", "meshes"))) as archive:
            archive.extractall(base, filter="data")
        sides = Side(HERE, Path(folder, "now")), Side(base, Path(folder, "before"))
        ratios = _take_turns(sides, options.rounds, began + options.seconds)
    print(_table(sides, ratios, options.base))
    print(f"{monotonic() - began:.0f} s, CPU times; a ratio below 1 means that the kernel is faster than before.")


def _take_turns(sides: tuple[Side, Side], rounds: int, until: float) -> dict[str, list[tuple[float, float]]]:
    """Seconds of each row, now and before, in each round."""
    with ThreadPoolExecutor() as both:
        list(both.map(Side.turn, sides))  # compiles
    measured: dict[str, list[tuple[float, float]]] = {name: [] for name in ROWS}
    for number in range(rounds):
        if number and monotonic() > until:
            break
        order = (0, 1) if number % 2 == 0 else (1, 0)  # so that neither side always comes second
        turns = dict(sorted((side, sides[side].turn()) for side in order))
        for name in turns[0].keys() & turns[1].keys():
            measured[name].append((turns[0][name], turns[1][name]))
    return measured


def _table(sides: tuple[Side, Side], measured: dict[str, list[tuple[float, float]]], base: str) -> str:
    lines = [f"{'kernel':30} {'now, ms':>9} {base[:12] + ', ms':>16} {'ratio':>6}  range over {'rounds'}"]
    for name, times in measured.items():
        gone = [
            f"{label}: {side.missing[name]}"
            for side, label in zip(sides, ("now", base), strict=True)
            if name in side.missing
        ]
        if gone or not times:
            lines.append(f"{name:30} not there ({'; '.join(gone) or 'no turn came to its end'})")
            continue
        ratios = sorted(now / before for now, before in times)
        now, before = (1000.0 * median(column) for column in zip(*times, strict=True))
        spread = f"{ratios[0]:.2f} to {ratios[-1]:.2f} in {len(ratios)}"
        lines.append(f"{name:30} {now:9.2f} {before:16.2f} {median(ratios):6.2f}  {spread}")
    return "\n".join(lines)


def _git(*command: str) -> bytes:
    return subprocess.run(["git", *command], cwd=HERE, capture_output=True, check=True).stdout


if __name__ == "__main__":
    try:
        main()
    except Exception as error:  # a report is all that this is: whatever goes wrong must not fail what calls it
        said = getattr(error, "stderr", None)
        print(f"no kernel times: {error}", said.decode().strip() if isinstance(said, bytes) else "")
