"""A short form of the script `odd_environments.py`: a sweep and the export of its runs in some of its environments."""

import pytest

from tests.runner.odd_environments import COMMANDS, attempt, folder_for, wrong

SHORT_FORM = (
    "HOME that is a file", "none of them", "LANG=C, PYTHONOPTIMIZE=1, PYTHONWARNINGS=error and 40 columns",
    "files of 8 KiB", "standard output closed", "a full disk behind standard output",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", SHORT_FORM)
def test_a_command_does_its_work_or_says_why_not(name, tmp_path):
    folder = folder_for(name, tmp_path)
    for command in ("sweep", "export"):
        code, output, errors = attempt(name, folder, COMMANDS[command])
        assert wrong(name, command, code, output, errors) is None
