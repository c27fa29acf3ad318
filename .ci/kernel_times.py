"""CPU time of the kernels in the working tree against those of a commit: a table of ratios, and never a failure.

    python .ci/kernel_times.py [--base REV] [--rounds N] [--seconds S]

Only cases are measured that a change of a source can have made slower, and the commit's side takes the compiled code of
the working tree where the sources are the same. Both sides are driven by their own `harness sweep` on the same small
experiments, in turn, so that what drifts on the machine meets both alike. A ratio above 1 says that the working tree
takes longer; its range is over the rounds.
"""

from __future__ import annotations

import argparse
import filecmp
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import monotonic

HERE = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(HERE))

from harness.kernel_cache import PACKAGE, all_sources  # noqa: E402

LONGEST = 300.0  # s for a command, compilation included
SECONDS = 300.0  # s after which no other case is begun

PUMPKIN = "mesh: pumpkin-1753.ply"
# Scene, motion, engine, the clock that stands for the kernel, and the module where the kernel begins.
CASES = {
    "grid, 20 000 spheres": (
        "shape: sphere, count: 20000",
        0.3,
        "duration: 0.1",
        "grid",
        "pair_seconds",
        "broadphase.grid",
    ),
    "sweep and prune, 5 000 spheres": (
        "shape: sphere, count: 5000",
        0.3,
        "duration: 0.1",
        "sap",
        "pair_seconds",
        "broadphase.sap",
    ),
    "hulls, 300 bodies": (
        f"shape: hull, {PUMPKIN}, count: 300",
        0.1,
        "duration: 0.3",
        "grid",
        "pair_seconds",
        "narrowphase.hull_pairs",
    ),
    "surfaces, 100 bodies": (
        f"shape: mesh, {PUMPKIN}, count: 100",
        0.1,
        "duration: 0.3",
        "grid",
        "pair_seconds",
        "narrowphase.mesh_pairs",
    ),
    "walls, 300 hulls": (
        f"shape: hull, {PUMPKIN}, count: 300",
        0.1,
        "duration: 0.3",
        "grid",
        "box_seconds",
        "narrowphase.walls",
    ),
    "events of spheres, cells": (
        "shape: sphere, count: 2000",
        0.3,
        "duration: 1",
        "predictive",
        "run_seconds",
        "motion.predictive.simulation",
    ),
    "events of spheres, lists": (
        "shape: sphere, count: 2000",
        0.45,
        "duration: 0.5",
        "predictive",
        "run_seconds",
        "motion.predictive.simulation",
    ),
    "events of hulls": (
        f"shape: hull, {PUMPKIN}, count: 200",
        0.05,
        "duration: 1",
        "predictive",
        "run_seconds",
        "motion.predictive.solid_simulation",
    ),
    "events of surfaces": (
        f"shape: mesh, {PUMPKIN}, count: 50",
        0.05,
        "duration: 1",
        "predictive",
        "run_seconds",
        "motion.predictive.solid_simulation",
    ),
}


def main() -> None:
    """Measure both sides and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--base", metavar="REV", default="HEAD~1", help="the commit to hold against (default: HEAD~1)")
    parser.add_argument("--rounds", metavar="N", type=int, default=3)
    parser.add_argument("--seconds", metavar="S", type=float, default=SECONDS, help="begin no case after so many")
    chosen = parser.parse_args()
    deadline = monotonic() + chosen.seconds
    with tempfile.TemporaryDirectory() as folder:
        base, cases = Path(folder, "base"), Path(folder, "cases")
        git("worktree", "add", "--quiet", "--detach", str(base), chosen.base)
        try:
            changed = changed_cases(base)
            if not changed:
                print(f"the kernels are those of {chosen.base}: there is nothing to time")
                return
            share_compiled(base)
            write_cases(cases, changed)
            sides = {"base": base, "here": HERE}
            rounds = []
            for number in range(chosen.rounds):
                databases = {name: Path(folder, f"{name}-{number}.db") for name in sides}
                rounds.append(measure(sides, cases, databases, deadline))
        finally:
            git("worktree", "remove", "--force", str(base))
    print_table(chosen.base, rounds, changed)


def changed_cases(base: Path) -> list[str]:
    """The cases for whose kernels a source differs from that of the commit."""

    def same(file: Path) -> bool:
        other = base / file.relative_to(HERE)
        return other.is_file() and filecmp.cmp(file, other, shallow=False)

    modules = {module for *_, module in CASES.values()}
    differ = {module for module in modules if not all(map(same, all_sources(f"harness.{module}")))}
    return [name for name, (*_, module) in CASES.items() if module in differ]


def share_compiled(base: Path) -> None:
    """Give the commit's side what this one has compiled: numba looks for it by the folder and the date of a source.

    Folders of compiled code are named by their sources, so that nothing is taken that was compiled of others.
    """
    for file in PACKAGE.rglob("*.py"):
        other = base / file.relative_to(HERE)
        if other.is_file() and filecmp.cmp(file, other, shallow=False):
            os.utime(other, ns=(file.stat().st_atime_ns, file.stat().st_mtime_ns))
    folders = {
        folder_of(file.parent): folder_of(base / file.parent.relative_to(HERE)) for file in PACKAGE.rglob("*.py")
    }
    for kernels in (PACKAGE / "__pycache__").glob("kernels-*"):
        for here, there in folders.items():
            if (kernels / here).is_dir():
                shutil.copytree(kernels / here, base / "harness" / "__pycache__" / kernels.name / there)


def folder_of(package: Path) -> str:
    """The name of the folder where numba keeps what was compiled of the sources of another."""
    return f"{package.name}_{hashlib.sha1(str(package).encode()).hexdigest()}"


def write_cases(folder: Path, chosen: list[str]) -> None:
    """An experiment file for each case that was chosen."""
    folder.mkdir()
    for number, (name, (scene, packing, motion, algorithm, *_)) in enumerate(CASES.items()):
        if name not in chosen:
            continue
        # packing = pi / 6 count (size / side)^3
        count = int(scene.rpartition("count: ")[2])
        ratio = (6 * packing / (3.141592653589793 * count)) ** (2 / 3)
        (folder / f"case{number}.yaml").write_text(
            f"title: {name}\nscene: {{{scene}, box_ratio: {ratio:.12g}, seed: 1}}\n"
            f"motion: {{{motion}, response: elastic}}\n"
            f"engine: {{algorithm: {algorithm}}}\nmeasure: {{repeats: 1}}\n"
        )


def measure(
    sides: dict[str, Path], cases: Path, databases: dict[str, Path], deadline: float
) -> dict[str, dict[str, float]]:
    """CPU seconds by side and case, of those cases that a side can run and that were begun in time."""
    for file in sorted(cases.glob("*.yaml")):  # one by one: a case that a side does not know costs itself alone
        if monotonic() < deadline:
            for name, checkout in sides.items():
                harness(checkout, "sweep", str(file), "--db", str(databases[name]), "--quiet")
    return {name: measured(checkout, databases[name]) for name, checkout in sides.items()}


def measured(checkout: Path, database: Path) -> dict[str, float]:
    """CPU seconds by case, of the runs of a side."""
    exported = harness(checkout, "export", "--db", str(database), "--format", "json").stdout
    runs = json.loads(exported or "{}").get("runs", [])
    metrics = {row["experiment"]: row["metrics"] for row in runs if row["status"] == "ok"}
    clocks = {name: (f"case{number}", clock) for number, (name, (*_, clock, _)) in enumerate(CASES.items())}
    return {name: metrics[case][clock] for name, (case, clock) in clocks.items() if clock in metrics.get(case, {})}


def print_table(base: str, rounds: list[dict[str, dict[str, float]]], changed: list[str]) -> None:
    """Ratios of the working tree to the base, by case."""
    print(f"CPU time against {base}: median of paired ratios [range], above 1 is slower")
    for name in CASES:
        if name not in changed:
            print(f"  {name:32} the same code")
            continue
        known = [one for one in rounds if name in one["here"] and name in one["base"]]
        pairs = [(one["here"][name], one["base"][name]) for one in known]
        ratios = [here / before for here, before in pairs if before > 0]
        if ratios:
            # a single pair has no range, and says little
            spread = f"[{min(ratios):.2f}, {max(ratios):.2f}]" if len(ratios) > 1 else "in a single round"
            print(f"  {name:32} {median(ratios):.2f} {spread}")
        else:
            print(f"  {name:32} not run on both sides")


def harness(checkout: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """A side's own command, whose failure shows in what is missing; one that takes too long ends the measurement."""
    return subprocess.run(
        [sys.executable, "-m", "harness", *words],
        cwd=checkout, env=os.environ | {"PYTHONPATH": str(checkout)},
        capture_output=True, text=True, check=False, timeout=LONGEST,
    )  # fmt: skip


def git(*words: str) -> None:
    subprocess.run(["git", "-C", str(HERE), *words], check=True, capture_output=True)


if __name__ == "__main__":
    try:
        main()
    except Exception as error:  # it reports, and decides nothing
        print(f"kernel times: not measured: {type(error).__name__}: {error}")
