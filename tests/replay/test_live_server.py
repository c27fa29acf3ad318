"""The live server answers its own page on this machine, and nobody and nothing else."""

import json
import socket
import threading
import urllib.request

import pytest

from harness.replay import live
from harness.replay.live import HOST, LONGEST_ADDRESS, MOST_REQUESTS, LiveServer


@pytest.fixture
def server():
    with LiveServer("<p>page</p>", lambda settings: {"settings": dict(settings)}) as opened:
        thread = threading.Thread(target=opened.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield opened
        opened.shutdown()
        thread.join()


def asked(server, request: bytes) -> tuple[int, bytes]:
    """Status and body of what a request, byte for byte, is answered; status 0 if it is not."""
    with socket.create_connection((HOST, server.server_port), timeout=20) as connection:
        answer = b""
        try:
            connection.sendall(request)
            connection.shutdown(socket.SHUT_WR)
        except OSError:  # it was refused before all of it was sent
            pass
        try:
            while block := connection.recv(65536):
                answer += block
        except ConnectionResetError:
            pass
    head, _, body = answer.partition(b"\r\n\r\n")
    return int(head.split()[1]) if head.startswith(b"HTTP/") else 0, body


def get(server, path="/", **headers):
    lines = {"Host": f"{HOST}:{server.server_port}"} | {name.replace("_", "-"): text for name, text in headers.items()}
    head = "".join(f"{name}: {text}\r\n" for name, text in lines.items())
    return asked(server, f"GET {path} HTTP/1.1\r\n{head}\r\n".encode("latin-1"))


def test_it_listens_on_this_machine_alone(server):
    assert server.server_address[0] == "127.0.0.1"
    with urllib.request.urlopen(server.address) as answer:
        assert answer.read() == b"<p>page</p>"
    status, body = get(server, "/run?count=3&speed=")
    assert (status, json.loads(body)) == (200, {"settings": {"count": "3", "speed": ""}})


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "elsewhere.example"},
        {"Host": "localhost"},
        {"Host": ""},
        {"Origin": "http://elsewhere.example"},
        {"Origin": "null"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
    ],
)
def test_a_page_from_elsewhere_is_refused(server, headers):
    assert get(server, "/run?count=3", **headers)[0] == 403


@pytest.mark.parametrize(
    ("request_line", "status"),
    [
        (b"POST /run HTTP/1.1\r\nHost: {}\r\nContent-Length: 99999999999\r\n\r\n", 501),
        (b"GET /etc/passwd HTTP/1.1\r\nHost: {}\r\n\r\n", 404),
        (b"GET /../../etc/passwd HTTP/1.1\r\nHost: {}\r\n\r\n", 404),
        (b"GET /" + b"a" * (LONGEST_ADDRESS + 1) + b" HTTP/1.1\r\nHost: {}\r\n\r\n", 414),
        (b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\nHost: {}\r\n\r\n", 414),
        (b"GET /run?" + b"a=1&" * 500 + b" HTTP/1.1\r\nHost: {}\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: {}\r\nHost: {}\r\n\r\n", 403),
        (b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 5000 + b"\r\n", 431),
        (b"GET / HTTP/1.1\r\nA: " + b"b" * 200_000 + b"\r\n\r\n", 431),
        (b"GET http://[::1 HTTP/1.1\r\nHost: {}\r\n\r\n", 400),
        (b"GET / HTTP/9.9\r\n\r\n", 505),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\r\n\r\n", 400),
        (b"\r\n", 0),
        (b"", 0),
    ],
)
def test_what_is_malformed_or_too_long_is_refused_and_the_next_is_answered(server, request_line, status, capfd):
    here = f"{HOST}:{server.server_port}".encode()
    found, _ = asked(server, request_line.replace(b"{}", here))
    assert found in (status, 0)  # 0: it was refused before all of it was sent
    assert get(server)[0] == 200
    assert capfd.readouterr().err == ""


@pytest.mark.slow
def test_requests_at_once_are_answered_in_turn_and_too_many_are_refused(server):
    held = [socket.create_connection((HOST, server.server_port), timeout=20) for _ in range(MOST_REQUESTS)]
    try:
        for connection in held:
            connection.sendall(b"GET / HTTP/1.1\r\n")  # and no more
        for _ in range(200):
            status, _ = get(server)
            if status != 200:
                break
        assert status in (503, 0)  # 0: the refusal was cut off with what was still being sent
    finally:
        for connection in held:
            connection.close()
    for _ in range(200):
        status, _ = get(server)
        if status == 200:
            break
    assert status == 200

    found = []
    threads = [threading.Thread(target=lambda n=n: found.append(get(server, f"/run?n={n}"))) for n in range(10)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(json.loads(body)["settings"]["n"] for status, body in found) == sorted(map(str, range(10)))


def test_a_connection_that_says_nothing_is_closed(server, monkeypatch):
    monkeypatch.setattr(live._Handler, "timeout", 0.1)
    with socket.create_connection((HOST, server.server_port), timeout=20) as connection:
        connection.sendall(b"GET / HT")
        assert connection.recv(100) == b""
    assert get(server)[0] == 200


def test_an_answer_that_fails_is_said_and_the_next_is_given(capfd):
    def answer(settings):
        if "bad" in settings:
            raise RuntimeError("no luck")
        return {"good": float("nan")} if "nan" in settings else {}

    with LiveServer("", answer) as opened:
        thread = threading.Thread(target=opened.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        assert "no luck" in json.loads(get(opened, "/run?bad=1")[1])["error"]
        assert "error" in json.loads(get(opened, "/run?nan=1")[1])
        assert json.loads(get(opened, "/run")[1]) == {}
        opened.shutdown()
        thread.join()
    assert capfd.readouterr().err == ""
