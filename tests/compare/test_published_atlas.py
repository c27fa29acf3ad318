"""What is published of the atlas holds: every accusation is proven anew, and reproductions show it where they can."""

import json
import subprocess
import sys
from copy import deepcopy
from importlib.metadata import PackageNotFoundError, version

import pytest

from harness.compare.script import LONGEST
from tests.compare.recheck import PUBLISHED, is_off, proven, told_apart

ROWS = json.loads(PUBLISHED.read_text())
GAPS = json.loads((PUBLISHED.parent / "gaps" / PUBLISHED.name).read_text())
SHOWN = [row for row in ROWS if row["file"]]


@pytest.mark.slow
def test_plain_fractions_prove_every_accusation():
    assert len(ROWS) >= 20
    for row in ROWS:
        assert row["says"] != row["touching"]
        assert proven(row), (row["engine"], row["family"])


@pytest.mark.slow
def test_plain_fractions_prove_every_accusation_about_a_gap_and_none_that_is_changed_to_the_truth():
    assert len(GAPS) >= 40
    for row in GAPS:
        bounds = told_apart(row)  # exact, and takes the time: both are held against the same
        assert is_off(row, *bounds), (row["engine"], row["family"])
        true = row["gap"] if row["query"] == "distance" else 0.0 if row["gap"] < row["within"] else None
        assert not is_off(row | {"told": true}, *bounds)
    assert proven(GAPS[0])


@pytest.mark.slow
def test_a_certificate_that_is_changed_proves_nothing():
    for row in ROWS[::3]:
        changed = deepcopy(row)
        if row["touching"]:
            changed["bodies"][0]["position"][0] += 1.0
        else:
            changed["bodies"][0]["position"] = changed["bodies"][1]["position"]
            if row["shape"] == "mesh":
                continue  # of the same place one surface may be inside of the other
        assert not proven(changed)


def test_at_least_five_reproductions_of_several_libraries_need_no_more_than_sixty_lines():
    assert len(SHOWN) >= 5
    assert len({row["engine"] for row in SHOWN}) >= 3
    for row in SHOWN:
        text = (PUBLISHED.parent / row["file"]).read_text()
        assert text.count("\n") <= LONGEST
        assert "harness" not in text


def test_fcls_wrong_distance_of_two_cubes_is_shown_without_this_program():
    script = PUBLISHED.parent / "gaps/reproductions/fcl-shared-hull.py"
    assert script.read_text().count("\n") <= LONGEST
    ended = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr  # it has proven the truth
    if version("python-fcl") == "0.7.0.11":
        assert ended.stdout.rstrip().endswith("\nreproduced")


@pytest.mark.slow
@pytest.mark.parametrize("row", SHOWN, ids=[row["file"].rpartition("/")[2] for row in SHOWN])
def test_a_reproduction_shows_the_error_in_the_version_that_it_is_told_of(row):
    try:
        installed = version(row["library"])
    except PackageNotFoundError:
        pytest.skip(f"{row['library']} is not installed")
    script = str(PUBLISHED.parent / row["file"])
    ended = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr  # it has proven the truth
    if installed == row["version"]:
        assert ended.stdout.rstrip().endswith("\nreproduced")
