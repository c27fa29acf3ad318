"""What says that memory ran out is told from other errors."""

import resource
import subprocess
import sys

import pytest

from harness.process_limits import out_of_memory
from tests.conftest import slow_beyond


def raised_from(inner):
    """As llvmlite raises what its library could not be loaded for."""
    try:
        try:
            raise inner
        except OSError:
            raise OSError("Could not find/load shared object file 'libllvmlite.so'")  # noqa: B904
    except OSError as error:
        return error


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (MemoryError(), True),
        (ImportError("libfcl.so: failed to map segment from shared object"), True),
        (OSError(12, "Cannot allocate memory"), True),
        (raised_from(OSError("libllvmlite.so: failed to map segment from shared object")), True),
        (raised_from(OSError("libllvmlite.so: no such file")), False),
        (ImportError("no module named numba"), False),
    ],
)
def test_an_error_for_want_of_memory_is_told_from_others(error, told):
    assert out_of_memory(error) is told


@pytest.mark.parametrize("megabytes", slow_beyond([400, 500]))
def test_a_command_without_room_for_its_libraries_says_so_instead_of_waiting(megabytes, tmp_path):
    ended = subprocess.run(
        [sys.executable, "-m", "harness", "report"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (megabytes * 10**6,) * 2),
    )
    assert (ended.returncode, ended.stdout) == (1, "")
    assert ended.stderr.startswith("memory ran out: this process may take less than the command needs")
