"""Whatever becomes of standard output and error, a command comes to its end, and says what was lost."""

import io
import os
import subprocess
import sys

import pytest

from harness.cli.streams import Reliable, speaks_unicode
from tests.conftest import slow_beyond

COMMAND = [sys.executable, "-m", "harness", "new", "mine.yaml"]


@pytest.fixture
def pipe():
    """A stream into a pipe, and the other end."""
    reader, writer = os.pipe()
    like = os.fdopen(os.dup(writer), "w", encoding="utf-8")
    stream = Reliable(writer, like, errors="backslashreplace")
    yield stream, reader
    stream.flush()
    like.close()
    os.close(writer)


def test_a_reader_that_has_gone_ends_nothing(pipe):
    stream, reader = pipe
    stream.write("first\n")
    stream.flush()
    assert os.read(reader, 100) == b"first\n"
    assert stream.lost is None
    os.close(reader)
    for _ in range(3):
        assert stream.write("x" * 100_000) == 100_000
        stream.flush()
    assert isinstance(stream.lost, BrokenPipeError)


def test_letters_that_the_terminal_does_not_know_are_written_as_numbers():
    reader, writer = os.pipe()
    like = os.fdopen(writer, "w", encoding="ascii")
    stream = Reliable(writer, like, errors="backslashreplace")
    stream.write("3 × …\n")
    stream.flush()
    assert os.read(reader, 100) == b"3 \\xd7 \\u2026\n"
    assert not speaks_unicode(stream)
    like.close()
    os.close(reader)


def test_every_line_is_out_at_once_where_python_is_told_not_to_buffer():
    reader, writer = os.pipe()
    unbuffered = io.TextIOWrapper(os.fdopen(os.dup(writer), "wb", 0), encoding="utf-8", write_through=True)
    stream = Reliable(writer, unbuffered, errors="backslashreplace")
    stream.write("3 of 90 runs\n")
    os.set_blocking(reader, False)
    assert os.read(reader, 100) == b"3 of 90 runs\n"
    unbuffered.close()
    os.close(reader)


def said(arguments, folder, **options):
    return subprocess.run(arguments, cwd=folder, stderr=subprocess.PIPE, text=True, **options)


def test_a_full_disk_behind_standard_output_is_said_and_exits_1(tmp_path):
    with open("/dev/full", "w") as full:
        for words in (COMMAND, [*COMMAND[:3], "--help"], [*COMMAND[:3], "new", "--help"]):
            done = said(words, tmp_path, stdout=full)
            assert done.returncode == 1
            assert done.stderr == "standard output took no more: No space left on device\n"
    assert (tmp_path / "mine.yaml").exists()  # what the command does was done


@pytest.mark.parametrize("closed", slow_beyond([(0, 1, 2), (1,), (2,)]))
def test_streams_that_are_closed_from_the_start_are_no_fault(tmp_path, closed):
    """Else the first file to be opened, perhaps a database, would get the number of standard output."""
    code = (
        "import os, sys\n"
        f"for number in {closed}: os.close(number)\n"
        f"os.execv(sys.executable, {[*COMMAND[:-1], 'other.yaml']!r})"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0
    assert "Traceback" not in done.stderr
    assert (tmp_path / "other.yaml").exists()


def test_a_command_whose_reader_has_gone_still_exits_with_its_own_code(tmp_path):
    for words, code in ((COMMAND[3:], 0), (COMMAND[3:], 2)):  # the second time the file is there
        reader, writer = os.pipe()
        os.close(reader)
        done = said([*COMMAND[:3], *words], tmp_path, stdout=writer)
        os.close(writer)
        assert done.returncode == code
        assert "Traceback" not in done.stderr
