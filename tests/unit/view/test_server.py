"""What cannot be served is refused with one line that has the remedy."""

import socket

import pytest

from cliffscan.cli import build_parser
from cliffscan.common.runtime.config import ConfigError
from cliffscan.view.access import Access
from cliffscan.view.command import address
from cliffscan.view.robots import Robots
from cliffscan.view.server import Server


def refusal(bind, port):
    with pytest.raises(ConfigError) as error:
        Server(bind, port, Access.to(bind), Robots("robot", "nowhere"))
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_port_that_is_taken():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        why = refusal("127.0.0.1", port)
    assert why.startswith(f"--bind 127.0.0.1 --port {port}: Address already in use")
    assert why.endswith("; another --port may be free")


def test_an_address_that_is_not_of_this_machine():
    assert refusal("192.0.2.1", 0).startswith("--bind 192.0.2.1 ")


def test_what_is_no_port(capsys):
    with pytest.raises(SystemExit):
        build_parser().parse_args(["view", "--port", "99999"])
    assert "'99999' is no port: expected 0 to 65535" in capsys.readouterr().err


def test_the_address_is_what_a_browser_opens():
    assert address("127.0.0.1", 8080, "") == "http://127.0.0.1:8080/"
    assert address("::1", 8080, "") == "http://[::1]:8080/"
    assert address("0.0.0.0", 80, "abc") == f"http://{socket.gethostname()}:80/?token=abc"  # noqa: S104
