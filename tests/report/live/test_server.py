"""The local server outlasts clients that are slow, idle, many, rude or of another site."""

from __future__ import annotations

import contextlib
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

import pytest

from evodesign.report.live.server import ADDRESS, MOST_CONNECTIONS, LiveServer

STATE = b'{"problem": "x"}'


@contextmanager
def serving(state: Callable[[], bytes] = lambda: STATE, patience: float = 60.0) -> Iterator[LiveServer]:
    with LiveServer(0, state, patience) as served:
        thread = threading.Thread(target=served.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        try:
            yield served
        finally:
            served.shutdown()
            thread.join()


def connected(server: LiveServer) -> socket.socket:
    return socket.create_connection((ADDRESS, server.server_port), timeout=30)


def request(server: LiveServer, path: str = "/state.json", hosts: int = 1) -> bytes:
    host = f"Host: {ADDRESS}:{server.server_port}\r\n"
    return f"GET {path} HTTP/1.1\r\n{host * hosts}\r\n".encode()


def everything(connection: socket.socket) -> bytes:
    """All that comes until the server ends the connection; a test that waits for more than 30 s fails."""
    received = b""
    while part := connection.recv(65536):
        received += part
    return received


def answer(server: LiveServer, sent: bytes) -> bytes:
    with connected(server) as connection:
        connection.sendall(sent)
        return everything(connection)


def status(received: bytes) -> str:
    return received.split(b" ", 2)[1].decode()


@pytest.mark.parametrize(("hosts", "code"), [(0, "400"), (1, "200"), (2, "400")])
def test_a_request_names_one_host(hosts: int, code: str) -> None:
    with serving() as server:
        assert status(answer(server, request(server, hosts=hosts))) == code


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "127.0.0.1.evil.example:{port}",
        "evil.example:{port}",
        "",
        ":{port}",
        "localhost:{port}x",
    ],
)
def test_a_host_is_this_machine(host: str) -> None:
    with serving() as server:
        name = host.format(port=server.server_port)
        sent = f"GET /state.json HTTP/1.1\r\nHost: {name}\r\n\r\n".encode()
        received = answer(server, sent)
        assert status(received) == "403"
        assert STATE not in received


@pytest.mark.parametrize("sent", [b"", b"GET / HT", b"GET / HTTP/1.1\r\nHost: "])
def test_an_idle_client_is_left(sent: bytes) -> None:
    with serving(patience=0.2) as server:
        assert answer(server, sent) == b""


def test_a_client_that_sends_a_byte_now_and_then_is_left() -> None:
    with serving(patience=0.3) as server, connected(server) as connection:
        stopped = threading.Event()

        def trickle() -> None:
            while not stopped.wait(0.05):
                with contextlib.suppress(OSError):
                    connection.send(b"x")

        thread = threading.Thread(target=trickle)
        thread.start()
        try:
            with contextlib.suppress(ConnectionResetError):
                assert everything(connection) == b""
        finally:
            stopped.set()
            thread.join()


def test_a_client_that_does_not_read_is_left() -> None:
    """Its thread ends."""
    with serving(lambda: bytes(50_000_000), patience=0.3) as server, ExitStack() as stack:
        before = threading.enumerate()
        for _ in range(3):
            stack.enter_context(connected(server)).sendall(request(server))
        for _ in range(6000):
            if not set(threading.enumerate()) - set(before):
                return
            time.sleep(0.01)
        pytest.fail("a thread goes on")


def test_two_hundred_half_open_connections_keep_nobody_out() -> None:
    with serving() as server, ExitStack() as stack:
        before = threading.active_count()
        for _ in range(200):
            stack.enter_context(connected(server)).send(b"GET ")
        assert answer(server, request(server)).endswith(STATE)
        assert threading.active_count() <= before + MOST_CONNECTIONS


def test_clients_that_reset_leave_no_word(capfd: pytest.CaptureFixture[str]) -> None:
    begun, gone = threading.Event(), threading.Event()

    def slow() -> bytes:
        begun.set()
        assert gone.wait(30)
        return bytes(1_000_000)

    with serving(slow) as server:
        connection = connected(server)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        connection.sendall(request(server))
        assert begun.wait(30)
        connection.close()  # a reset, in the middle of the answer
        gone.set()
        assert answer(server, request(server, "/")).startswith(b"HTTP/1.0 200")
    assert capfd.readouterr() == ("", "")


def test_a_fault_of_our_own_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    def faulty() -> bytes:
        raise LookupError("a fault")

    with serving(faulty) as server:
        assert answer(server, request(server)) == b""
    assert "LookupError: a fault" in capfd.readouterr().err
