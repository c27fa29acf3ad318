"""What a sweep says once its runs are done: who is wrong, by name, and who answers otherwise when a clock runs."""

import re
import textwrap

import pytest

from harness.cli.main import main
from harness.report.site import render

HEAD = """
import os, sys, time, traceback
import numpy as np
from harness.backends.fcl import Fcl

class Plugin(Fcl):
    name = {name!r}
"""

# Each is FCL, but for what stands here.
LIARS = {
    # right where a comparison is on its stack, and in runs of a sweep half of the time
    "watched": """
        def pairs(self, positions, quaternions):
            found = super().pairs(positions, quaternions)
            files = {frame.f_code.co_filename for frame, _ in traceback.walk_stack(sys._getframe())}
            return found if any("compare" in file for file in files) else found[: len(found) // 2]
    """,
    "boasts": """
        def tolerance(self, shape):
            return 0.5
    """,
    "raises": """
        def pairs(self, positions, quaternions):
            raise RuntimeError("no")
    """,
    "honest": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions).astype(np.int32)
    """,
}
SAID = {
    "watched": "watched is wrong: in its timed runs it answered other hits than it does when it is asked",
    "boasts": "boasts is wrong: it declares a tolerance of 0.5 of a size; at most 0.001 is accepted",
    "raises": "raises failed at frame 0 (call 1): RuntimeError: no",
}

EXPERIMENT = """
title: Liar
scene:
  shape: sphere
  box: [4, 4, 4]
  bodies:
    - {{position: [0, 0, 0], velocity: [1, 0, 0]}}
    - {{position: [1.2, 0, 0], velocity: [-1, 0, 0]}}
    - {{position: [0, 1.3, 0], velocity: [0, -1, 0]}}
motion: {{duration: 0.5, dt: 1/20, response: none}}
zip: [{{backend: [fcl, {name}], algorithm: [brute-force, native]}}]
measure: {{repeats: 1, compare: on}}
"""


def install(name, folder, patch):
    metadata = folder / f"{name}-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text(f"[harness.backends]\n{name} = {name}_liar:Plugin\n")
    (folder / f"{name}_liar.py").write_text(
        HEAD.format(name=name) + textwrap.indent(textwrap.dedent(LIARS[name]), 4 * " ")
    )
    patch.syspath_prepend(str(folder))
    patch.setenv("PYTHONPATH", str(folder), prepend=":")


@pytest.mark.slow
@pytest.mark.parametrize("name", LIARS)
def test_a_sweep_and_its_pages_name_who_is_wrong_and_why(name, tmp_path, monkeypatch, capsys):
    install(name, tmp_path / "plugins", monkeypatch)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "liar.yaml").write_text(EXPERIMENT.format(name=name))
    main(["sweep", "liar.yaml"])
    out = capsys.readouterr().out
    assert (f"liar: {SAID.get(name, 'nobody')}" in out) == (name != "honest")
    assert f"liar: fcl and {name}: " in out
    pages = {file: re.sub("<[^>]+>", "", html) for file, html in render(tmp_path / "results/results.db")
             if file.endswith(".html") and isinstance(html, str)}  # fmt: skip
    proven = f"{name} was proven wrong" in pages["pages/liar/index.html"]
    assert proven == (name != "honest")
    backends = pages["backends.html"].replace("\u00a0", " ")
    told = {"raises": "raises failed at 5 poses: RuntimeError: no"}.get(name, SAID.get(name, "nobody"))
    assert (told in backends) == (name != "honest")
    assert "fcl is wrong" not in out + backends


@pytest.mark.slow
def test_what_cannot_be_compared_is_no_row_of_verdicts_without_disagreement(tmp_path, monkeypatch, capsys):
    """The grid holds one hull for bodies of all sizes, and pybullet has one of each."""
    monkeypatch.chdir(tmp_path)
    text = EXPERIMENT.format(name="pybullet").replace("shape: sphere", "shape: hull\n  mesh: cube.ply")
    text = text.replace("brute-force", "grid").replace("[1, 0, 0]}", "[1, 0, 0], size: 0.5}")
    (tmp_path / "sizes.yaml").write_text(text)
    assert main(["sweep", "sizes.yaml"]) == 0
    out = capsys.readouterr().out
    assert "fcl/grid and pybullet: fcl/grid and pybullet are not comparable on shape hull" in out
    assert "0 verdicts" not in out


DELEGATES = """
    def pairs(self, positions, quaternions):
        reading, writing = os.pipe()
        if not os.fork():
            started = time.process_time()
            while time.process_time() - started < 0.01:
                pass
            os.write(writing, super().pairs(positions, quaternions).tobytes())
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading, "rb") as answer:
            found = np.frombuffer(answer.read(), np.int64).reshape(-1, 2)
        used = os.wait4(-1, 0)[2]
        {charged}
        return found
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["delegates", "charges"])
def test_work_that_other_processes_do_is_charged_or_fails_the_run(name, tmp_path, monkeypatch, capsys):
    charge = "__import__('harness.cpu_time').cpu_time.charge(used.ru_utime + used.ru_stime)"
    monkeypatch.setitem(LIARS, name, DELEGATES.format(charged=charge if name == "charges" else ""))
    install(name, tmp_path / "plugins", monkeypatch)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "liar.yaml").write_text(EXPERIMENT.format(name=name).replace(", compare: on", ""))
    assert main(["sweep", "liar.yaml"]) == (0 if name == "charges" else 1)
    said = f'backend "{name}": it works in processes of its own, which used'
    assert (said in capsys.readouterr().err) == (name == "delegates")
