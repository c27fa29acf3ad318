"""Experiments made of strings, in a folder of their own."""

from collections.abc import Callable
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.experiment.experiment import Experiment
from harness.experiment.load import load_text

Read = Callable[..., Experiment]
ProblemsIn = Callable[..., list[str]]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with two meshes to name."""
    monkeypatch.chdir(tmp_path)
    for name in ("cube.ply", "duck.obj"):
        (tmp_path / name).write_text("not looked into here")
    return tmp_path


@pytest.fixture
def read(folder: Path) -> Read:
    """Load a text as the file exp.yaml."""
    return lambda text, **set: load_text(text, "exp.yaml", set)


@pytest.fixture
def problems_in(folder: Path) -> ProblemsIn:
    """Every problem of a text, as it is said."""

    def problems(text: str | bytes, **set: object) -> list[str]:
        with pytest.raises(InputError) as caught:
            load_text(text, "exp.yaml", set)
        return [str(problem) for problem in caught.value.problems]

    return problems
