"""The server behind a live page: this machine alone can reach it, and it answers two requests."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Lock
from typing import Any
from urllib.parse import parse_qsl, urlsplit

HOST = "127.0.0.1"
Answer = Callable[[Mapping[str, str]], Mapping[str, Any]]


class LiveServer(ThreadingHTTPServer):
    """Serves a page, and what its settings lead to, on a free port of this machine.

    Parameters
    ----------
    page : HTML
    answer : from the settings on the page to a JSON document; it is asked one question at a time
    """

    daemon_threads = True

    def __init__(self, page: str, answer: Answer) -> None:
        super().__init__((HOST, 0), _Handler)
        self.page = page
        self._answer = answer
        self._lock = Lock()

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return f"http://{HOST}:{self.server_port}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that has left before its answer came is no error."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)

    def answer(self, settings: Mapping[str, str]) -> Mapping[str, Any]:
        """What these settings lead to, after all that was asked before."""
        with self._lock:
            return self._answer(settings)


class _Handler(BaseHTTPRequestHandler):
    server: LiveServer

    def do_GET(self) -> None:
        parts = urlsplit(self.path)
        # the name under which it was asked for: a page elsewhere may point a name of its own to this machine
        if self.headers.get("Host") != f"{HOST}:{self.server.server_port}":
            self.send_error(HTTPStatus.FORBIDDEN)
        elif parts.path == "/":
            self._send("text/html; charset=utf-8", self.server.page)
        elif parts.path == "/run":
            settings = dict(parse_qsl(parts.query, keep_blank_values=True))
            self._send("application/json", json.dumps(self.server.answer(settings), allow_nan=False))
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def _send(self, kind: str, text: str) -> None:
        content = text.encode()
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing; the page says what comes of a request."""
