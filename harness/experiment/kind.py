"""What a YAML file declares: an experiment, or a set of cases with proven times of impact."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

LARGEST_FILE = 1_000_000
"""bytes that are read of one"""

_SIGN = re.compile(rb"^families\s*:", re.MULTILINE)


def is_truth_declaration(path: Path) -> bool:
    """Whether a file declares a set of cases: it has the key `families`, which no experiment has."""
    try:
        with path.open("rb") as stream:
            return _SIGN.search(stream.read(LARGEST_FILE)) is not None
    except (OSError, ValueError):
        return False


def find_truth_declarations(paths: Iterable[str | os.PathLike[str]]) -> list[Path]:
    """Those that paths name: files, and all *.yaml below folders; sorted within a folder."""
    found: list[Path] = []
    for path in map(Path, paths):
        files = sorted(path.rglob("*.yaml")) if path.is_dir() else [path]
        found += [file for file in files if file.is_file() and is_truth_declaration(file)]
    return list(dict.fromkeys(found))
