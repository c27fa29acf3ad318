"""Write a commented experiment to start from."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from harness.cli.width import say
from harness.experiment import FOLDER

if TYPE_CHECKING:
    from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    parser.add_argument("name", metavar="NAME", help=f"for {FOLDER}/NAME.yaml; or a path that ends in .yaml")


def run(arguments: argparse.Namespace) -> int:
    """Write the file, never over another, and say what to do next."""
    from pathlib import Path

    from harness.errors import InputError, Problem
    from harness.whole_file import write_whole

    name: str = arguments.name
    path = Path(name) if name.endswith(".yaml") else Path(FOLDER) / f"{name}.yaml"
    beside = not name.endswith(".yaml") and (Path(name).is_absolute() or ".." in Path(name).parts)
    if beside or not name.isprintable() or not name.strip("/."):
        raise InputError(f'"{name}" is no name for a file in {FOLDER}/; a path must end in .yaml')
    try:
        write_whole(path, _text(path), replace=False)
    except FileExistsError:
        raise InputError([Problem("this exists already, and is left as it is", str(path))]) from None
    except OSError as error:
        raise InputError([Problem(f"this cannot be written: {error.strerror}", str(path))]) from None
    say(f"wrote {path}")
    say(f"check it with `harness validate {path}`, run it with `harness sweep {path}`, then `harness report`")
    return 0


def _text(path: Path) -> str:
    import json
    from importlib.resources import files

    template = (files("harness.experiment") / "template.yaml").read_text(encoding="utf-8")
    title = path.stem.replace("-", " ").replace("_", " ").capitalize()
    return template.format(title=json.dumps(title, ensure_ascii=False), path=path)
