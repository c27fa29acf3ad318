"""Backends with a known defect, installed for one test as packages of their own would be."""

from __future__ import annotations

import textwrap

import pytest

# Each is FCL, but for what stands below.
DEFECTS = {
    "drops": """
        hits = 0
        def pairs(self, positions, quaternions):
            found = super().pairs(positions, quaternions)
            kept = [(self.hits + k + 1) % 1000 != 0 for k in range(len(found))]
            self.hits += len(found)
            return found[kept]
    """,
    "flips": """
        def load(self, scene):
            super().load(scene)
            self.sizes = scene.bodies.sizes
        def pairs(self, positions, quaternions):
            touching = set(map(tuple, super().pairs(positions, quaternions).tolist()))
            for i in range(len(positions)):
                for j in range(i + 1, len(positions)):
                    reach = (self.sizes[i] + self.sizes[j]) / 2
                    if abs(np.linalg.norm(positions[i] - positions[j]) - reach) < 1e-6 * reach:
                        touching ^= {(i, j)}
            return np.array(sorted(touching), int).reshape(-1, 2)
    """,
    "inflates": """
        def load(self, scene):
            bodies = scene.bodies.copy()
            bodies.sizes *= 1.001
            super().load(dataclasses.replace(scene, bodies=bodies))
    """,
    "unturned": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, np.tile([1.0, 0, 0, 0], (len(positions), 1)))
    """,
    "swaps": """
        def pairs(self, positions, quaternions):
            order = np.arange(len(positions))
            order[[0, 1]] = 1, 0
            return super().pairs(positions[order], quaternions[order])
    """,
    "blind": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions)[:0]
    """,
    "blind-too": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions)[:0]
    """,
    "crashes": """
        calls = 0
        def pairs(self, positions, quaternions):
            if abs(positions[0, 0]) > 0.9:
                os.kill(os.getpid(), signal.SIGSEGV)
            return super().pairs(positions, quaternions)
    """,
    "forks": """
        def pairs(self, positions, quaternions):
            started = os.fork()
            if started == 0:
                os.setsid()
                time.sleep(600)
                os._exit(0)
            open(os.environ["HARNESS_TEST_NOTE"], "w").write(str(started))
            return super().pairs(positions, quaternions)
    """,
    "crashes-loading": """
        def load(self, scene):
            os.kill(os.getpid(), signal.SIGSEGV)
    """,
    "raises-loading": """
        def load(self, scene):
            raise RuntimeError("no luck")
    """,
    "hangs-loading": """
        def load(self, scene):
            time.sleep(600)
    """,
    "loads-once": """
        def load(self, scene):
            if os.path.exists(os.environ["HARNESS_TEST_NOTE"]):
                raise RuntimeError("loaded before")
            open(os.environ["HARNESS_TEST_NOTE"], "w").close()
            super().load(scene)
        def pairs(self, positions, quaternions):
            os.kill(os.getpid(), signal.SIGSEGV)
    """,
    "prints": """
        def pairs(self, positions, quaternions):
            print("garbage", flush=True)
            os.write(1, b"garbage")
            os.write(2, b"garbage")
            return super().pairs(positions, quaternions)
    """,
    "hangs": """
        def pairs(self, positions, quaternions):
            if abs(positions[0, 0]) > 0.9:
                time.sleep(1000)
            return super().pairs(positions, quaternions)
    """,
}


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    """Comparisons are kept in results/results.db of the working folder."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def defective(tmp_path, monkeypatch):
    """Installs a backend of a name in `DEFECTS`, and returns the name."""

    def install(name: str) -> str:
        folder = tmp_path / "plugins"
        metadata = folder / f"{name.replace('-', '_')}-1.0.dist-info"
        metadata.mkdir(parents=True)
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        module = f"{name.replace('-', '_')}_backend"
        (metadata / "entry_points.txt").write_text(f"[harness.backends]\n{name} = {module}:Plugin\n")
        head = f"""
            import dataclasses, os, signal, time
            import numpy as np
            from harness.backends.fcl import Fcl

            class Plugin(Fcl):
                name = {name!r}
            """
        body = textwrap.indent(textwrap.dedent(DEFECTS[name]), 4 * " ")
        (folder / f"{module}.py").write_text(textwrap.dedent(head) + body)
        monkeypatch.syspath_prepend(str(folder))
        return name

    return install


def two_spheres(path, duration):
    """An experiment of two spheres that overlap at rest; its path."""
    path.write_text(
        "title: Two\n"
        "scene: {shape: sphere, box: [4, 4, 4], bodies: [{position: [0, 0, 0]}, {position: [0.5, 0, 0]}]}\n"
        f"motion: {{duration: {duration}, dt: 1/30, response: none}}\n"
    )
    return str(path)
