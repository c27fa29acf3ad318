"""What is printed for people fits the columns that there are, and is one line elsewhere, for other programs."""

import pytest

from harness.cli.main import COMMANDS, main

EXPERIMENT = """
title: A title that is longer than forty letters are
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.1}
sweep: {algorithm: [grid, predictive]}
"""


def too_long(text, columns):
    return [line for line in text.splitlines() if len(line) > columns and " " in line.strip()]


@pytest.fixture
def said(tmp_path, monkeypatch, capsys):
    """What a command prints at a width."""
    (tmp_path / "long.yaml").write_text(EXPERIMENT)
    monkeypatch.chdir(tmp_path)

    def run(columns, *words):
        monkeypatch.setenv("COLUMNS", columns)
        assert main(words) == 0
        return capsys.readouterr().out

    return run


@pytest.mark.parametrize("words", [("plan", "long.yaml"), ("list",), ("trace", "long.yaml"), ("new", "a.yaml")])
def test_lines_are_broken_between_words_where_columns_are_few(said, words):
    narrow, whole = said("40", *words), said("", *words[:-1], words[-1].replace("a.y", "b.y"))
    assert too_long(narrow, 40) == []
    assert narrow.replace("a.y", "b.y").split() == whole.split()
    assert max(map(len, whole.splitlines())) > 60


@pytest.mark.parametrize("command", ["", *COMMANDS, "mesh inspect", "truth ask"])
@pytest.mark.parametrize("columns", [40, 80])
def test_help_fits_too(monkeypatch, capsys, command, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    with pytest.raises(SystemExit):
        main([*command.split(), "--help"])
    _, _, rest = capsys.readouterr().out.partition("\n\n")  # argparse breaks usage between options, not in them
    assert too_long(rest, columns) == []


def test_a_paragraph_of_help_is_filled_and_a_table_is_not(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "62")
    with pytest.raises(SystemExit):
        main(["mesh", "--help"])
    help_text = capsys.readouterr().out
    assert "  harness mesh make pumpkin --faces 1753\n  harness mesh inspect meshes/*.ply\n" in help_text
    assert "cut into triangles by\near clipping" in help_text
