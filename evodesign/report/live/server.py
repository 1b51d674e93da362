"""Serves the page and the state of one search to this machine alone.

The server listens on the loopback address, answers two paths, and answers only requests that name it by a
loopback name: a page of another site that got its own name resolved to this machine reads nothing. The page
asks for the state again and again; nothing is fetched from anywhere else.
"""

from __future__ import annotations

from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files

from evodesign.errors import EvodesignError, InputError

__all__ = ["ADDRESS", "LiveServer"]

ADDRESS = "127.0.0.1"
NAMES = (ADDRESS, "localhost")
"""Names by which a request may call this machine."""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'"


class LiveServer(ThreadingHTTPServer):
    """Serves until it is shut down.

    Args:
        port: to listen on; 0 for any free one.
        state: gives the state as JSON at every request.
    Raises:
        InputError: the port is taken.
    """

    daemon_threads = True

    def __init__(self, port: int, state: Callable[[], bytes]) -> None:
        self.state = state
        self.page = files("evodesign.report.live").joinpath("page.html").read_bytes()
        try:
            super().__init__((ADDRESS, port), _Handler)
        except OSError as error:
            raise InputError("--port", "", "a free port", f"{port} ({error.strerror})") from error

    @property
    def url(self) -> str:
        """Where a browser finds the page."""
        return f"http://{ADDRESS}:{self.server_port}/"


class _Handler(BaseHTTPRequestHandler):
    server: LiveServer
    server_version = "evodesign"
    sys_version = ""

    def do_GET(self) -> None:
        """Answer with the page or the state."""
        if self.headers.get("Host", "").rpartition(":")[0] not in NAMES:
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
