"""Serves the page and the state of one search to this machine alone.

The server listens on the loopback address, answers two paths, and answers only requests that name it by a
loopback name: a page of another site that got its own name resolved to this machine reads nothing. The page
asks for the state again and again; nothing is fetched from anywhere else.

A connection serves one request and has `PATIENCE` for it, however slowly its bytes come or go. When too many
are open, the oldest makes place.
"""

from __future__ import annotations

import re
import socket
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any

from evodesign.errors import EvodesignError, InputError

ADDRESS = "127.0.0.1"
NAMES = (ADDRESS, "localhost")
HOST = re.compile(rf"({'|'.join(map(re.escape, NAMES))})(:\d{{1,5}})?")
"""Names by which a request may call this machine; another port is that of a tunnel."""

PATIENCE = 10.0
"""Time [s] that a connection has for its request and answer."""

MOST_CONNECTIONS = 16
"""Connections at the same time; a browser opens six."""

PLACE_WAIT = 1.0
"""Longest time [s] for which a new connection waits for the oldest one to end."""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'"


class LiveServer(ThreadingHTTPServer):
    """Serves until it is shut down.

    Args:
        port: to listen on; 0 for any free one.
        state: gives the state as JSON at every request.
        patience: time [s] that a connection has.
    Raises:
        InputError: the port is taken.
    """

    daemon_threads = True
    request_queue_size = 128

    def __init__(self, port: int, state: Callable[[], bytes], patience: float = PATIENCE) -> None:
        self.state = state
        self.patience = patience
        self._begun: dict[socket.socket, float] = {}
        self._ended = threading.Condition()
        self.page = files("evodesign.report.live").joinpath("page.html").read_bytes()
        try:
            super().__init__((ADDRESS, port), _Handler)
        except OSError as error:
            raise InputError("--port", "", "a free port", f"{port} ({error.strerror})") from error

    @property
    def url(self) -> str:
        """Where a browser finds the page."""
        return f"http://{ADDRESS}:{self.server_port}/"

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a connection in a thread of its own, when there is a place for it."""
        with self._ended:
            if len(self._begun) >= MOST_CONNECTIONS:
                _cut(next(iter(self._begun)))
                self._ended.wait_for(lambda: len(self._begun) < MOST_CONNECTIONS, PLACE_WAIT)
            has_place = len(self._begun) < MOST_CONNECTIONS
            if has_place:
                self._begun[request] = time.monotonic()
        if has_place:
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def shutdown_request(self, request: Any) -> None:
        """Close a connection, which gives its place away."""
        super().shutdown_request(request)
        with self._ended:
            self._begun.pop(request, None)
            self._ended.notify()

    def service_actions(self) -> None:
        """End the connections whose time is over; called between requests."""
        with self._ended:
            for request, begun in self._begun.items():
                if time.monotonic() - begun > self.patience:
                    _cut(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Be quiet about connections that were reset, cut or too slow."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


def _cut(connection: socket.socket) -> None:
    """End a connection under whoever reads from it or writes to it."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)


class _Handler(BaseHTTPRequestHandler):
    server: LiveServer
    server_version = "evodesign"
    sys_version = ""

    def setup(self) -> None:
        """Let no read or write take longer than a connection may."""
        super().setup()
        self.connection.settimeout(self.server.patience)

    def do_GET(self) -> None:
        """Answer with the page or the state."""
        hosts = self.headers.get_all("Host", [])
        if len(hosts) != 1:
            self.send_error(400, "wanted one Host")
        elif not HOST.fullmatch(hosts[0]):
            self.send_error(403, "only by the name of this machine")
        elif self.path == "/":
            self._respond("text/html; charset=utf-8", self.server.page)
        elif self.path == "/state.json":
            self._state()
        else:
            self.send_error(404)

    def _state(self) -> None:
        try:
            state = self.server.state()
        except EvodesignError as error:  # the run has gone, or cannot be read
            self._respond("text/plain; charset=utf-8", str(error).encode(), code=503)
        else:
            self._respond("application/json", state)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - as the base class has it
        """Write nothing to the terminal."""

    def _respond(self, kind: str, content: bytes, *, code: int = 200) -> None:
        self.send_response(code)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)
