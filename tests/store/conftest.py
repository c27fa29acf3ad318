from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.store.database import Database


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "results.db"


@pytest.fixture
def database(path: Path) -> Iterator[Database]:
    with Database.open(path, create=True) as opened:
        yield opened
