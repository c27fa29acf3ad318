"""`harness view` runs an experiment and writes a page that holds what happened."""

import base64
import json
import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request

import numpy as np
import psutil
import pytest

from harness.cli.main import main

EXPERIMENT = """
title: Two spheres
scene:
  shape: sphere
  box: [8, 4, 4]
  bodies:
    - {position: [-2, 0, 0], velocity: [1, 0, 0]}
    - {position: [2, 0, 0], velocity: [-1, 0, 0]}
motion: {duration: 4, response: elastic}
engine: {algorithm: predictive}
"""


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    (tmp_path / "two.yaml").write_text(EXPERIMENT)
    return tmp_path / "two.yaml"


def carried(page):
    return json.loads(re.search(r'id="recording">(.*?)</script>', page, re.DOTALL).group(1))


def array(document, name):
    kind, offset, length = document["arrays"][name]
    return np.frombuffer(base64.b64decode(document["data"]), f"<{kind}", length, offset)


@pytest.mark.slow
def test_the_page_holds_the_hits_where_the_closed_form_has_them(file, capsys):
    assert main(["view", str(file)]) == 0
    path = file.parent / "results" / "replays" / "two.html"
    assert capsys.readouterr().out.strip() == "results/replays/two.html"
    document = carried(path.read_text(encoding="utf-8"))
    assert array(document, "hit_times").tolist() == [1.5]  # 4 apart, reach 1, closing at 2 m/s
    assert array(document, "leg_starts").tolist() == [0, 2, 4]
    assert array(document, "leg_times").tolist() == [0, 1.5, 0, 1.5]
    assert array(document, "leg_velocities")[3:6].tolist() == [-1, 0, 0]


@pytest.mark.slow
def test_a_run_that_cannot_be_exits_1_and_a_file_that_cannot_be_written_2(file, capsys):
    assert main(["view", str(file), "--set", "count=300", "--set", "speed=1"]) == 1
    assert "the run failed (rejected)" in capsys.readouterr().err
    (file.parent / "taken").write_text("")
    assert main(["view", str(file), "--out", "taken/page.html"]) == 2
    assert "give another file with --out" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 0), (signal.SIGKILL, -signal.SIGKILL)])
def test_a_live_server_ends_with_its_command_and_leaves_no_process(file, number, code):
    command = [sys.executable, "-m", "harness", "view", "--live", str(file)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as view:
        try:
            address = view.stdout.readline().split()[0]
            with urllib.request.urlopen(f"{address}run?speed=2") as answer:
                assert "row" in json.load(answer)
            started = psutil.Process(view.pid).children(recursive=True)
            assert started
            view.send_signal(number)
            assert view.wait(timeout=60) == code
            assert view.stderr.read() == ""
        finally:
            view.kill()
    _, left = psutil.wait_procs(started, timeout=20)
    assert left == []
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address)
