"""`harness truth ask`: what counts as right, missed, late, early and false, and what a failing backend costs."""

import json
import os
import re
from functools import cache
from html import unescape
from pathlib import Path

import fcl
import numpy as np
import pytest

from harness.backends import registry
from harness.backends.protocol import ImpactTimes
from harness.cli.main import main
from harness.report.site import render
from harness.truth import folder as folder_of_cases
from harness.truth.case_scene import CaseScenes
from harness.truth.folder import COLUMNS, read_set

PUBLISHED = Path(__file__).parents[2] / "results/published/truth"
STILL = dict.fromkeys(COLUMNS, "0") | {"shape": "sphere", "mesh_a": "", "mesh_b": "", "qw_a": "1", "qw_b": "1"}
# Balls of 1 m on a line, the second coming at 1 m/s from gaps of 1 m and 0.5 m, and from inside; and one that goes.
CASES = [
    {"x_b": "2", "vx_b": "-1", "lower": "0.9999999995", "upper": "1.0000000005"},
    {"x_b": "1.5", "vx_b": "-1", "lower": "0.4999999995", "upper": "0.5000000005"},
    {"x_b": "0.5", "vx_b": "-1", "lower": "0", "upper": "0"},
    {"x_b": "2", "vx_b": "1", "lower": "2", "upper": ""},
]


@pytest.fixture
def folder(tmp_path):
    lines = [",".join(COLUMNS)]
    for case in CASES:
        row = STILL | {"family": "head_on", "size_a": "1", "size_b": "1", "window": "2"} | case
        row["verdict"] = "touches" if row["upper"] else "never"
        lines.append(",".join(row[name] for name in COLUMNS))
    (tmp_path / "cases.csv").write_text("\n".join([*lines, ""]))
    return tmp_path


class Told:
    """A backend whose times are true of two balls on a line, and then changed."""

    name, shapes, queries = "told", ("sphere",), ("collision", "impact")

    def __init__(self, change):
        self._change = change

    def tolerance(self, shape):
        return 1e-9

    def load(self, scene):
        pass

    def pairs(self, positions, quaternions):
        touch = np.linalg.norm(positions[0] - positions[1]) <= 1.0
        return np.array([(0, 1)] if touch else [], np.int64).reshape(-1, 2)

    def impacts(self, positions, quaternions, velocities, spins, duration):
        gap, speed = positions[1, 0] - positions[0, 0] - 1.0, velocities[0, 0] - velocities[1, 0]
        time = self._change(gap / speed if gap > 0.0 < speed else np.inf)
        found = [(0, 1)] if time <= duration else []
        return ImpactTimes(np.array(found, np.int64).reshape(-1, 2), np.array([time] * len(found), np.float64))


def crashes(time):
    os.abort()


def hangs(time):
    while time < 1.0:
        pass
    return time


@pytest.mark.parametrize(
    ("change", "counted"),
    [
        (lambda time: time, {"right": 4}),
        (lambda time: time + 1e-3, {"right": 2, "late": 2}),
        pytest.param(lambda time: time - 1e-3, {"right": 2, "early": 2}, marks=pytest.mark.slow),
        pytest.param(lambda time: time + 1.2e-9, {"right": 4}, marks=pytest.mark.slow),
        pytest.param(lambda time: np.inf, {"right": 2, "missed": 2}, marks=pytest.mark.slow),
        pytest.param(lambda time: 1.0, {"right": 1, "late": 2, "false": 1}, marks=pytest.mark.slow),
        (crashes, {"failed": 4}),
        (hangs, {"right": 3, "failed": 1}),
    ],
    ids=["true", "late", "early", "in tolerance", "missing", "always", "crashing", "hanging"],
)
def test_answers_are_counted_for_what_they_are(folder, monkeypatch, capsys, change, counted):
    declared = registry.DeclaredBackend(lambda: lambda: Told(change))
    known = registry._declared()
    name = f"told{len(counted)}{id(change)}"
    monkeypatch.setattr(registry, "_declared", lambda: {**known, name: declared})
    assert main(["truth", "ask", str(folder), "--backends", name, "--timeout", "1", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["backends"][0]["families"]["head_on"]
    names = ("right", "missed", "late", "early", "false", "failed")
    assert {name: found[name] for name in names if found[name]} == counted
    if counted == {"right": 2, "late": 2}:
        assert found["latest"] == pytest.approx(1e-3, abs=1e-8)


def test_the_engine_is_right_and_steps_are_late_by_less_than_a_frame(folder, capsys):
    # from the gap of 1 m and of 0.5 m: frames of 0.3 s see it at 1.2 and 0.6 s
    assert main(["truth", "ask", str(folder), "--backends", "own,fcl/brute-force", "--dt", "0.3", "--json"]) == 0
    own, stepped = (asked["families"]["all"] for asked in json.loads(capsys.readouterr().out)["backends"])
    assert (own["right"], own["asked"]) == (4, 4)
    assert (stepped["right"], stepped["late"], stepped["asked"]) == (2, 2, 4)
    assert stepped["latest"] == pytest.approx(0.2, abs=1e-8)


def test_a_table_has_a_line_a_family_and_says_which_shapes_were_left_out(folder, capsys):
    pytest.importorskip("ipctk")
    assert main(["truth", "ask", str(folder), "--backends", "own,ipctk"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:4] for line in lines[1:3]] == [["own", "head_on", "4", "4"], ["own", "all", "4", "4"]]
    assert lines[-1] == "ipctk: 4 cases are of shapes that it does not have, and were not asked"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--backends", "nosuch"], 'there is no backend "nosuch"'),
        (["--backends", "fcl/grid"], "of one pair there is nothing to leave out"),
        (["--families", "nosuch"], "there is no family nosuch"),
        (["--dt", "0"], "a time must be above 0"),
        (["--every", "0"], "it must be a whole number, 1 or more"),
    ],
)
def test_what_cannot_be_asked_is_a_sentence_and_exit_code_2(folder, capsys, arguments, said):
    try:
        code = main(["truth", "ask", str(folder), *arguments])
    except SystemExit as error:
        code = error.code
    assert code == 2
    streams = capsys.readouterr()
    assert said in streams.err
    assert streams.out == ""


@pytest.fixture
def published(monkeypatch):
    """The published set, which is read once: its 10 000 cases take seconds."""
    monkeypatch.setattr(folder_of_cases, "read_set", lambda path: read_published() if path == PUBLISHED else None)
    return read_published()


@cache
def read_published():
    return read_set(PUBLISHED)


@pytest.mark.slow
def test_published_rows_are_answered_right_by_the_engine(published, capsys):
    assert main(["truth", "ask", str(PUBLISHED), "--every", "250", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["backends"][0]["families"]
    assert (found["all"]["right"], found["all"]["asked"]) == (42, 42)
    assert len(found) == 11


@pytest.mark.slow
def test_slow_approaches_are_answered_no_farther_apart_than_the_tolerance(published, capsys):
    # a gap of 1.6e-12 of a size, as if the tolerance were that, would be 7.7e-9 s before the touch
    assert main(["truth", "ask", str(PUBLISHED), "--families", "resting", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["backends"][0]["families"]["resting"]
    assert (found["right"], found["asked"]) == (500, 500)


@pytest.mark.slow
def test_fcl_sees_published_pairs_apart_at_the_lower_bound_and_touching_at_the_upper_one(published):
    """FCL knows nothing of the proofs, and is asked in other arithmetic."""
    given = published
    scenes, cases = CaseScenes(given), given.cases
    rows = np.flatnonzero(np.isfinite(cases.upper) & (cases.lower > 0.0)).tolist()
    assert len(rows) > 6000
    wrong = []
    backend, kind = registry.create("fcl"), None
    for row in sorted(rows, key=scenes.kind):
        motion = scenes.motion(row)
        if scenes.kind(row) != kind:
            kind = scenes.kind(row)
            backend.load(scenes.scene(row))
        touching = [len(backend.pairs(*motion.at(float(bound[row])))) for bound in (cases.lower, cases.upper)]
        if touching != [0, 1]:
            wrong.append(given.lines[row])
    assert not wrong, f"{wrong} of cases.csv, with python-fcl {fcl.__version__}"


def test_answers_that_are_kept_have_a_page_which_the_overview_links(folder, monkeypatch, capsys):
    late = registry.DeclaredBackend(lambda: lambda: Told(lambda time: time + 1e-3))
    known = registry._declared()
    monkeypatch.setattr(registry, "_declared", lambda: {**known, "late": late})
    database = str(folder / "answers.db")
    for names in ("own,late", "late"):  # the second answers take the place of the first
        assert main(["truth", "ask", str(folder), "--backends", names, "--db", database]) == 0
    pages = dict(render(database))
    assert 'href="truth.html"' in pages["index.html"]
    page = unescape(re.sub(r"<[^>]+>", "|", pages["truth.html"])).replace("\u00a0", " ")
    assert "own is right about all of 4 cases." in page
    assert "late is right about 2 of 4 cases: 2 late; the latest answer comes 0.001" in page
    assert [name for name in pages if name.startswith("truth-") and name.endswith(".svg")]
    assert "backends.html" not in pages  # nobody was compared with anybody
