"""Why an endpoint cannot be reached is one line, whatever its host is called."""

import socket
from threading import Thread

import pytest

from cliffscan.common.runtime.tls_probe import why_unreachable


@pytest.mark.parametrize("host", ["robot..local", "x" * 70, "."])
@pytest.mark.parametrize("protocol", ["tcp", "tls"])
def test_a_host_that_can_have_no_such_name(protocol, host):
    endpoint = f"{protocol}/{host}:7447"
    assert why_unreachable(endpoint, None) == f"{endpoint}: no host can have that name: is it right?"


@pytest.mark.parametrize(
    ("answer", "words"),
    [(b"HTTP/1.1 400 Bad Request\r\n\r\n", "what answers there is no router: is the port right?"), (b"", "")],
)
def test_another_server_is_told_from_one_that_hangs_up(answer, words):
    with socket.create_server(("127.0.0.1", 0)) as server:
        endpoint = f"tcp/127.0.0.1:{server.getsockname()[1]}"
        greeted = Thread(target=answered, args=(server, answer))
        greeted.start()
        why = why_unreachable(endpoint, None)
        greeted.join()
    assert why == (f"{endpoint}: {words}" if words else "")


def answered(server, answer):
    with server.accept()[0] as connection:
        connection.recv(1024)
        connection.sendall(answer)
