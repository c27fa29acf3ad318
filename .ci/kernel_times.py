"""CPU time of the kernels in the working tree against those of a commit: a table of ratios, and never a failure.

    python .ci/kernel_times.py [--base REV] [--rounds N]

Both sides are driven by their own `harness sweep` on the same small experiments, in turn, so that what drifts on the
machine meets both alike. A ratio above 1 says that the working tree takes longer; its range is over the rounds.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

HERE = Path(__file__).resolve().parents[1]

PUMPKIN = "mesh: pumpkin-1753.ply"
# Scene, motion, engine, and the clock that stands for the kernel.
CASES = {
    "grid, 20 000 spheres": ("shape: sphere, count: 20000", 0.3, "duration: 0.1", "grid", "pair_seconds"),
    "sweep and prune, 5 000 spheres": ("shape: sphere, count: 5000", 0.3, "duration: 0.1", "sap", "pair_seconds"),
    "hulls, 300 bodies": (f"shape: hull, {PUMPKIN}, count: 300", 0.1, "duration: 0.3", "grid", "pair_seconds"),
    "surfaces, 100 bodies": (f"shape: mesh, {PUMPKIN}, count: 100", 0.1, "duration: 0.3", "grid", "pair_seconds"),
    "walls, 300 hulls": (f"shape: hull, {PUMPKIN}, count: 300", 0.1, "duration: 0.3", "grid", "box_seconds"),
    "events of spheres, cells": ("shape: sphere, count: 2000", 0.3, "duration: 1", "predictive", "run_seconds"),
    "events of spheres, lists": ("shape: sphere, count: 2000", 0.45, "duration: 0.5", "predictive", "run_seconds"),
    "events of hulls": (f"shape: hull, {PUMPKIN}, count: 200", 0.05, "duration: 1", "predictive", "run_seconds"),
    "events of surfaces": (f"shape: mesh, {PUMPKIN}, count: 50", 0.05, "duration: 1", "predictive", "run_seconds"),
}


def main() -> None:
    """Measure both sides and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--base", metavar="REV", default="HEAD~1", help="the commit to hold against (default: HEAD~1)")
    parser.add_argument("--rounds", metavar="N", type=int, default=3)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        base, cases = Path(folder, "base"), Path(folder, "cases")
        git("worktree", "add", "--quiet", "--detach", str(base), chosen.base)
        try:
            write_cases(cases)
            sides = {"base": base, "here": HERE}
            rounds = []
            for number in range(chosen.rounds):
                databases = {name: Path(folder, f"{name}-{number}.db") for name in sides}
                rounds.append({name: measure(sides[name], cases, databases[name]) for name in sides})
        finally:
            git("worktree", "remove", "--force", str(base))
    print_table(chosen.base, rounds)


def write_cases(folder: Path) -> None:
    """An experiment file for each case."""
    folder.mkdir()
    for number, (name, (scene, packing, motion, algorithm, _)) in enumerate(CASES.items()):
        # packing = pi / 6 count (size / side)^3
        count = int(scene.rpartition("count: ")[2])
        ratio = (6 * packing / (3.141592653589793 * count)) ** (2 / 3)
        (folder / f"case{number}.yaml").write_text(
            f"title: {name}\nscene: {{{scene}, box_ratio: {ratio:.12g}, seed: 1}}\n"
            f"motion: {{{motion}, response: elastic}}\n"
            f"engine: {{algorithm: {algorithm}}}\nmeasure: {{repeats: 1}}\n"
        )


def measure(checkout: Path, cases: Path, database: Path) -> dict[str, float]:
    """CPU seconds by case, of those that the checkout can run."""
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    harness, kept = [sys.executable, "-m", "harness"], ["--db", str(database)]
    for file in sorted(cases.glob("*.yaml")):  # one by one: a case that a side does not know costs itself alone
        run([*harness, "sweep", str(file), *kept, "--quiet"], checkout, environment)
    exported = run([*harness, "export", *kept, "--format", "json"], checkout, environment).stdout
    runs = json.loads(exported or "{}").get("runs", [])
    metrics = {row["experiment"]: row["metrics"] for row in runs if row["status"] == "ok"}
    clocks = {name: (f"case{number}", clock) for number, (name, (*_, clock)) in enumerate(CASES.items())}
    return {name: metrics[case][clock] for name, (case, clock) in clocks.items() if clock in metrics.get(case, {})}


def print_table(base: str, rounds: list[dict[str, dict[str, float]]]) -> None:
    """Ratios of the working tree to the base, by case."""
    print(f"CPU time against {base}: median of paired ratios [range], above 1 is slower")
    for name in CASES:
        known = [one for one in rounds if name in one["here"] and name in one["base"]]
        pairs = [(one["here"][name], one["base"][name]) for one in known]
        ratios = [here / before for here, before in pairs if before > 0]
        if ratios:
            print(f"  {name:32} {median(ratios):.2f} [{min(ratios):.2f}, {max(ratios):.2f}]")
        else:
            print(f"  {name:32} not there on both sides")


def run(command: list[str], folder: Path, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """A command whose failure shows in what is missing."""
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def git(*words: str) -> None:
    subprocess.run(["git", "-C", str(HERE), *words], check=True, capture_output=True)


if __name__ == "__main__":
    try:
        main()
    except Exception as error:  # it reports, and decides nothing
        print(f"kernel times: not measured: {type(error).__name__}: {error}")
