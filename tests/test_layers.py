"""Imports run one way: each room knows only those that the design lets it know."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "harness"
BASE = {"arrays", "errors", "kernel", "kernel_cache", "python_child", "vocabulary"}
GEOMETRY = {"scene", "narrowphase", "broadphase", "backends"}
KNOWS = {
    "experiment": set(),
    "scene": set(),
    "narrowphase": {"scene"},
    "broadphase": {"scene"},
    "backends": {"scene", "narrowphase", "broadphase"},
    "measure": {"experiment", "scene"},
    "motion": GEOMETRY | {"measure"},
    "store": set(),
    "compare": GEOMETRY | {"motion", "measure"},
    "runner": GEOMETRY | {"experiment", "measure", "motion", "store"},
    "replay": {"store"},
    "report": {"store", "measure", "replay"},
    "cli": GEOMETRY | {"experiment", "measure", "motion", "store", "compare", "runner", "replay", "report"},
}


def rooms_imported(file: Path) -> set[str]:
    tree = ast.parse(file.read_text(encoding="utf-8"))
    modules = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    modules += [name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names]
    return {module.split(".")[1] for module in modules if module.startswith("harness.")}


@pytest.mark.parametrize("room", sorted(KNOWS))
def test_a_room_imports_only_what_it_may_know(room):
    for file in (PACKAGE / room).rglob("*.py"):
        strangers = rooms_imported(file) - KNOWS[room] - BASE - {room}
        assert not strangers, f"{file.relative_to(PACKAGE)} imports {sorted(strangers)}"


def test_every_room_has_its_rule():
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
