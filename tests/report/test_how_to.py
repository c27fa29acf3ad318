"""What the page "How to" tells people to type exists."""

import argparse
import re
import shutil
from html import unescape
from importlib import import_module
from pathlib import Path

import pytest
import trimesh

from harness.cli.main import COMMANDS, main
from harness.report.page import pages_of
from harness.report.results import Results
from tests.test_readme import commands

QUICKSTART = Path(__file__).parents[2] / "experiments" / "quickstart.yaml"


@pytest.fixture(scope="module")
def page(pages):
    return pages["how-to.html"]


def snippets(page):
    return [unescape(text) for text in re.findall(r"<pre[^>]*><code>(.*?)</code></pre>", page, re.DOTALL)]


def test_every_command_exists(page):
    spoken = re.findall(r"<code>harness (\w+)", page)
    typed = [words[0] for text in snippets(page) for words in commands(text)]
    assert len(typed) > 5
    assert {*spoken, *typed} - {"COMMAND"} <= COMMANDS.keys()


def test_every_line_that_is_typed_is_one_its_command_takes(page):
    for text in snippets(page):
        for name, *words in commands(text):
            parser = argparse.ArgumentParser(exit_on_error=False)
            import_module(f"harness.cli.{name}").add_arguments(parser)
            parser.parse_args(words)


def test_the_lines_about_meshes_and_sweeps_run(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    trimesh.creation.icosphere(subdivisions=3).export("duck.obj")
    Path("experiments").mkdir()
    shutil.copy(QUICKSTART, "experiments")
    lines = [words for text in snippets(page) for words in commands(text) if words[0] in ("mesh", "sweep")]
    assert len(lines) > 8
    for words in lines:
        flown = words[0] == "sweep" and "--cluster" not in words and "--dry-run" not in words
        if "--cluster" not in words:
            assert main([*words, "--dry-run"] if flown else words) == 0, words


def test_what_is_said_in_python_is_python(page):
    lines = [text for text in snippets(page) if "import " in text]
    assert lines
    for text in lines:
        compile(text, "how-to", "exec")


def test_the_pages_that_it_names_are_there(database, page):
    titles = {found.title for found, _ in pages_of(Results(database))}
    assert "All points" in titles
    assert "“All points”" in page
