"""What is published beside the set holds: files that show wrong answers of libraries without this program."""

import re
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version

import pytest

from harness.compare.script import LONGEST_OF_MOTION
from tests.truth.reproductions import PUBLISHED

FILES = sorted((PUBLISHED / "reproductions").glob("*.py"))
MADE_WITH = {"python-fcl": "0.7.0.11", "rapier3d": "0.36.1"}


def test_wrong_answers_in_several_families_are_shown_by_files_of_few_lines():
    assert len({path.name.split("-")[1] for path in FILES}) >= 8
    for path in FILES:
        text = path.read_text()
        assert text.count("\n") <= LONGEST_OF_MOTION
        assert "harness" not in text


@pytest.mark.slow
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_file_proves_the_truth_and_shows_the_error_in_the_version_that_it_was_made_with(path):
    library = re.match('"""([^:]+):', path.read_text())[1]
    try:
        installed = version(library)
    except PackageNotFoundError:
        pytest.skip(f"{library} is not installed")
    ended = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    if installed == MADE_WITH[library]:
        assert ended.stdout.endswith("\nreproduced\n")
