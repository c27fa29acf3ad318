"""Servers that outlive a command, so that the many commands of these tests need not start them anew.

That a command starts its servers and ends them is tested with the real command (`tests/runner`).
"""

from __future__ import annotations

import pytest

from harness.runner.servers import Servers


class SharedServers:
    """Servers that others use too: leaving the context ends none of them."""

    def __init__(self, servers: Servers) -> None:
        self._servers = servers
        self.run, self.interrupt = servers.run, servers.interrupt

    def __enter__(self) -> SharedServers:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def close(self) -> None:
        pass


@pytest.fixture(scope="session")
def servers():
    with Servers() as opened:
        yield opened


@pytest.fixture(autouse=True)
def share_servers(servers, monkeypatch):
    """Every sweep and every trace in this process gets the same servers."""
    for module in ("executor", "sweep"):
        monkeypatch.setattr(f"harness.runner.{module}.Servers", lambda: SharedServers(servers))
