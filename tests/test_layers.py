"""Imports run one way: each folder knows only those that the design lets it know."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from harness.vocabulary import ALGORITHMS

PACKAGE = Path(__file__).parents[1] / "harness"
BASE = {
    "arrays",
    "child_process",
    "descendants",
    "cpu_time",
    "errors",
    "installed",
    "kernel",
    "kernel_cache",
    "kept_files",
    "modules",
    "prefetch",
    "process_limits",
    "python_child",
    "threads",
    "vocabulary",
    "whole_file",
    "workers",
}
KERNELS = {"scene", "narrowphase", "broadphase"}
FLIGHT = KERNELS | {"backends", "measure", "motion", "methods"}
KNOWS = {
    "experiment": set(),
    "scene": set(),
    "narrowphase": {"scene"},
    "broadphase": {"scene"},
    "backends": {"scene", "narrowphase"},
    "measure": {"experiment", "scene"},
    "motion": KERNELS | {"measure"},
    "reference": KERNELS | {"backends", "measure", "motion"},
    "methods": KERNELS | {"backends", "measure", "motion"},
    "store": set(),
    "compare": FLIGHT,
    "truth": FLIGHT | {"experiment", "pair", "reference", "compare"},
    "runner": FLIGHT | {"experiment", "reference", "store"},
    "replay": {"store"},
    "report": {"store", "measure", "replay"},
    "pair": {"experiment", "scene", "narrowphase"},
    "cli": FLIGHT | {"experiment", "reference", "store", "compare", "truth", "runner", "replay", "report"},
}
LIBRARIES = {
    "fcl",
    "pybullet",
    "coal",
    "igl",
    "ipctk",
    "mujoco",
    "mujoco_warp",
    "py_parry3d",
    "pydrake",
    "rapier3d",
    "trimesh",
    "warp",
}


def folders_imported(file: Path) -> set[str]:
    tree = ast.parse(file.read_text(encoding="utf-8"))
    modules = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    modules += [name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names]
    return {module.split(".")[1] for module in modules if module.startswith("harness.")}


@pytest.mark.parametrize("folder", sorted(KNOWS))
def test_a_folder_imports_only_what_it_may_know(folder):
    for file in (PACKAGE / folder).rglob("*.py"):
        allowed = KNOWS[folder] | BASE | {folder}
        if allowed.issuperset(re.findall(r"\bharness\.(\w+)", file.read_text(encoding="utf-8"))):
            continue  # it names no other, so that it need not be parsed
        unknown = folders_imported(file) - allowed
        assert not unknown, f"{file.relative_to(PACKAGE)} imports {sorted(unknown)}"


@pytest.mark.parametrize("folder", ["narrowphase", "broadphase"])
def test_kernels_import_no_collision_library(folder):
    for file in (PACKAGE / folder).rglob("*.py"):
        imported = [
            name.name if isinstance(node, ast.Import) else node.module or ""
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
            if isinstance(node, ast.Import | ast.ImportFrom)
            for name in node.names
        ]
        assert not LIBRARIES & {module.split(".")[0] for module in imported}, file.relative_to(PACKAGE)


@pytest.mark.slow
def test_no_file_outside_of_the_methods_and_the_vocabulary_names_an_algorithm():
    words = set(ALGORITHMS)
    for file in PACKAGE.rglob("*.py"):
        if file.relative_to(PACKAGE).parts[0] in ("methods", "vocabulary.py"):
            continue
        quoted = {
            node.value.rpartition("/")[2]  # alone, or as the end of a pipeline's name
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
        }
        assert not words & quoted, f"{file.relative_to(PACKAGE)} names {sorted(words & quoted)}"


def test_every_folder_has_its_rule():
    assert {folder.name for folder in PACKAGE.iterdir() if (folder / "__init__.py").exists()} == set(KNOWS)


@pytest.mark.parametrize("statement", ["import harness", "import harness.cli.main; harness.cli.main.main(['--help'])"])
def test_the_start_imports_nothing_heavy(statement):
    heavy = ("numpy", "numba", "matplotlib", "pandas", "yaml", "pydantic", "trimesh", "rich", "fcl", "pybullet")
    check = (
        "import sys\n"
        f"try:\n    {statement}\nexcept SystemExit:\n    pass\n"
        f"print([name for name in {heavy} if name in sys.modules], file=sys.stderr)"
    )
    ran = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=True)
    assert ran.stderr.strip() == "[]"
