"""Experiments as text, and backends that behave badly, installed for one test."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest

from harness.experiment.load import load_text

SPHERES = """
title: Spheres
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.5}
measure: {repeats: 2, timeout: 20}
"""


@pytest.fixture
def spheres(tmp_path):
    """Loads the small experiment above, with leaves set from outside."""

    def load(text: str = SPHERES, **leaves: object):
        return load_text(text, tmp_path / "spheres.yaml", leaves)

    return load


def install_plugin(folder: Path, patch: pytest.MonkeyPatch, name: str, body: str = "", head: str = "") -> None:
    """Install a backend whose `pairs` has the given body, under the given name; `head` runs when it is imported."""
    metadata = folder / f"{name}-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text(f"[harness.backends]\n{name} = {name}_backend:Plugin\n")
    imports = "import ctypes, os, signal, sys, time\nimport numpy as np\n"
    source = f"""
        class Plugin:
            name = {name!r}
            shapes = ("sphere", "hull", "mesh")
            calls = 0

            def tolerance(self, shape):
                return 1e-9

            def load(self, scene):
                pass

            def pairs(self, positions, quaternions):
                self.calls += 1
        """
    lines = imports + head + textwrap.dedent(source) + textwrap.indent(textwrap.dedent(body), 8 * " ")
    (folder / f"{name}_backend.py").write_text(lines + "\n        return np.empty((0, 2), int)\n")
    patch.syspath_prepend(str(folder))
    patch.setenv("PYTHONPATH", str(folder), prepend=":")


@pytest.fixture
def plugin(tmp_path, monkeypatch):
    """As `install_plugin`, for one test."""

    def install(name: str, body: str = "", head: str = "") -> None:
        install_plugin(tmp_path / "plugins", monkeypatch, name, body, head)

    return install
