"""No web page of others reads or stops a robot, and beyond this machine nobody does without the token."""

import socket

import pytest

from cliffscan.view.access import Access, is_loopback

HERE = Access.to("127.0.0.1")


@pytest.mark.parametrize("bind", ["127.0.0.1", "::1", "localhost", "127.3.2.1"])
def test_this_machine_needs_no_token(bind):
    assert is_loopback(bind)
    assert Access.to(bind).without_token("") == ""


@pytest.mark.parametrize("bind", ["0.0.0.0", "::", "192.168.1.5", "robot.local", ""])  # noqa: S104
def test_others_need_one_that_nobody_guesses(bind):
    access = Access.to(bind)
    assert len(access.token) >= 20
    assert access.token != Access.to(bind).token
    assert access.without_token(access.token) == ""
    for wrong in ("", "x", access.token[:-1], access.token + "x", "ä"):
        assert "?token=" in access.without_token(wrong)


def test_a_server_is_named_by_a_number_or_by_this_machine():
    own = socket.gethostname()
    for host in ("127.0.0.1:8080", "192.168.1.5:8080", "[::1]:8080", "[::1]", "localhost", "LOCALHOST:1", f"{own}:80"):
        assert HERE.stranger(host) == "", host


@pytest.mark.parametrize("host", ["evil.example:8080", "127.0.0.1.evil.example", "localhost.evil.example:1", ""])
def test_a_name_that_an_attacker_let_point_here_is_refused(host):
    assert "is not this machine" in HERE.stranger(host)


def test_only_pages_of_this_server_open_a_socket():
    host = "127.0.0.1:8080"
    assert HERE.foreign_page(f"http://{host}", host) == ""
    assert HERE.foreign_page(None, host) == ""  # no browser
    for origin in ("http://evil.example", "http://127.0.0.1:81", "https://127.0.0.1:8080", "null", ""):
        assert "--allow-origin" in HERE.foreign_page(origin, host), origin


def test_another_page_may_be_allowed():
    access = Access.to("127.0.0.1", ["https://app.example.org"])
    assert access.foreign_page("https://app.example.org", "127.0.0.1:1") == ""
    assert access.foreign_page("https://app.example.org.evil", "127.0.0.1:1") != ""
