"""Servers that outlive a command, so that the many commands of these tests need not start them anew.

That a command starts its servers and ends them is seen where the real command is (`tests/runner`).
"""

from __future__ import annotations

import pytest

from harness.runner.servers import Servers


class Lent:
    """Servers of somebody else: leaving them ends nothing."""

    def __init__(self, servers: Servers) -> None:
        self._servers = servers
        self.run, self.interrupt = servers.run, servers.interrupt

    def __enter__(self) -> Lent:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def close(self) -> None:
        pass


@pytest.fixture(scope="module")
def servers():
    with Servers() as opened:
        yield opened


@pytest.fixture(autouse=True)
def lent(servers, monkeypatch):
    """Every sweep and every trace in this process gets the same servers."""
    for module in ("executor", "sweep"):
        monkeypatch.setattr(f"harness.runner.{module}.Servers", lambda: Lent(servers))
