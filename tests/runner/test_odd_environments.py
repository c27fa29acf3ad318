"""A short form of the script `odd_environments.py`: in each environment, a sweep and the export of its runs."""

import pytest

from tests.runner.odd_environments import COMMANDS, ENVIRONMENTS, attempt, folder_for, wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_a_command_does_its_work_or_says_why_not(name, tmp_path):
    folder = folder_for(name, tmp_path)
    for command in ("sweep", "export"):
        code, output, errors = attempt(name, folder, COMMANDS[command])
        assert wrong(name, command, code, output, errors) is None
