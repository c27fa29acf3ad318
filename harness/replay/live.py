"""The server behind a live page: this machine alone can reach it, and it answers two requests."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import BoundedSemaphore, Lock
from typing import Any
from urllib.parse import parse_qsl, urlsplit

HOST = "127.0.0.1"
MOST_REQUESTS = 16  # at a time
LONGEST_ADDRESS = 4096
SLOWEST = 30.0  # s that may pass within a request or an answer
Answer = Callable[[Mapping[str, str]], Mapping[str, Any]]


class LiveServer(ThreadingHTTPServer):
    """Serves a page, and what its inputs lead to, on a free port of this machine.

    Parameters
    ----------
    page : HTML
    answer : from the inputs on the page to a JSON document; it is asked one question at a time
    """

    daemon_threads = True

    def __init__(self, page: str, answer: Answer) -> None:
        super().__init__((HOST, 0), _Handler)
        self.page = page
        self._answer = answer
        self._lock = Lock()
        self._room = BoundedSemaphore(MOST_REQUESTS)

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return f"http://{HOST}:{self.server_port}/"

    def process_request(self, request: Any, client_address: Any) -> None:
        """Hand a request to a thread, unless there are too many already."""
        if self._room.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            with suppress(OSError):
                request.send(b"HTTP/1.0 503 Too many requests at a time\r\n\r\n")
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """In a thread of its own: answer, and make room for another."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._room.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that has left before its answer came is no error."""
        if not isinstance(sys.exc_info()[1], ConnectionError | TimeoutError):
            super().handle_error(request, client_address)

    def answer(self, inputs: Mapping[str, str]) -> Mapping[str, Any]:
        """What these inputs lead to, after all that was asked before."""
        with self._lock:
            return self._answer(inputs)


class _Handler(BaseHTTPRequestHandler):
    server: LiveServer
    timeout = SLOWEST

    def do_GET(self) -> None:
        try:
            parts = urlsplit(self.path)
            inputs = dict(parse_qsl(parts.query, keep_blank_values=True, max_num_fields=100))
        except ValueError:
            self.send_error(HTTPStatus.BAD_REQUEST)
            return
        if len(self.path) > LONGEST_ADDRESS:
            self.send_error(HTTPStatus.REQUEST_URI_TOO_LONG)
        elif self._is_foreign():
            self.send_error(HTTPStatus.FORBIDDEN)
        elif parts.path == "/":
            self._send("text/html; charset=utf-8", self.server.page)
        elif parts.path == "/run":
            self._send("application/json", self._answered(inputs))
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def _answered(self, inputs: Mapping[str, str]) -> str:
        try:
            return json.dumps(self.server.answer(inputs), allow_nan=False)
        except Exception as error:  # the page says it, and asks again
            return json.dumps({"error": f"This could not be answered: {type(error).__name__}: {error}."})

    def _is_foreign(self) -> bool:
        """Whether a page from elsewhere asks, or one that points a name of its own to this machine."""
        here = f"{HOST}:{self.server.server_port}"
        return (
            self.headers.get_all("Host") != [here]
            or self.headers.get("Origin", f"http://{here}") != f"http://{here}"
            or self.headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin")
        )

    def _send(self, kind: str, text: str) -> None:
        content = text.encode()
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing; the page says what comes of a request."""
