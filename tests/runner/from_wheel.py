"""Builds a wheel, installs it alone, and works with it in an empty folder: a new experiment, a sweep, pages, a replay.

    python tests/runner/from_wheel.py

The libraries are those of this Python. Prints each step, and how many went wrong.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

SOURCE = Path(__file__).parents[2]
# What must come along with the code: of each kind a file, below the folder of the installed packages.
BROUGHT = ("meshes/pumpkin-1753.ply", "harness/experiment/template.yaml", "harness/store/schema.sql")
STEPS = (
    ("new", "mine"),
    ("validate", "experiments/mine.yaml"),
    ("plan", "experiments/mine.yaml"),
    ("sweep", "experiments/mine.yaml", "--quiet"),
    ("sweep", "--quiet"),
    ("report",),
    ("view", "experiments/mine.yaml", "--out", "replay.html"),
    ("list",),
    ("mesh", "--help"),
    ("export", "--out", "results.csv"),
)
MADE = ("experiments/mine.yaml", "results/results.db", "results/report/index.html", "replay.html", "results.csv")


def install(folder: Path) -> Path:
    """A virtual environment with the wheel of this program, which sees the libraries of this one; its Python."""
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps"]
    subprocess.run([*pip, "-w", str(folder / "wheels"), str(SOURCE)], check=True)
    (wheel,) = (folder / "wheels").glob("*.whl")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder / "venv")], check=True)
    python = folder / "venv/bin/python"
    site = next((folder / "venv/lib").glob("python*/site-packages"))
    subprocess.run(
        [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-deps", str(wheel)],
        check=True,
    )
    # but for a link to these sources, which would hide what the wheel lacks
    libraries = [path for path in sys.path if path.endswith("site-packages")] or [sysconfig.get_paths()["purelib"]]
    (site / "libraries.pth").write_text("\n".join(libraries) + "\n")
    return python


def main() -> int:
    """Install, work, look; the number of steps that went wrong."""
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        python = install(folder)
        work = folder / "work"
        work.mkdir()
        environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "DISPLAY")}

        def says(*words: str) -> subprocess.CompletedProcess[str]:
            return subprocess.run([str(python), *words], cwd=work, env=environment, capture_output=True, text=True)

        place = Path(says("-c", "import harness; print(harness.__file__)").stdout.strip()).parents[1]
        if not place.is_relative_to(folder):
            print(f"WRONG: the program is that of {place}, not of the wheel")
            return 1
        for brought in BROUGHT:
            if not (place / brought).is_file():
                wrong += 1
                print(f"WRONG: {brought} does not come along")
        for step in STEPS:
            done = says("-m", "harness", *step)
            good = done.returncode == 0 and "Traceback" not in done.stderr
            wrong += not good
            print(
                f"harness {' '.join(step)}: exit code {done.returncode}{'' if good else ' WRONG ' + done.stderr[-500:]}"
            )
        for made in MADE:
            if not (work / made).is_file():
                wrong += 1
                print(f"WRONG: {made} was not made")
        shutil.rmtree(work)
    print(f"{len(STEPS) + len(BROUGHT) + len(MADE)} checks, {wrong} failures")
    return wrong


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
