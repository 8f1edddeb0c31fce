"""The page's server: credits, the newest picture, the stop button, and who may connect."""

import time
import urllib.error
import urllib.request

import msgpack
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from tests.service.conftest import DEADLINE, scan
from tests.service.view.conftest import View
from tests.view_page import PROTOCOL, Page, opening

QUIET = 0.4  # [s] in which a packet comes that may
STAMP = 10**18


def get(port, path="/", **headers):
    """Status, headers and text of a file."""
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=DEADLINE) as answer:  # noqa: S310
            return answer.status, answer.headers, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read().decode()


def refused(port, **options):
    """The status with which a socket is refused."""
    with pytest.raises(InvalidStatus) as error, opening(port, **options):
        pass
    return error.value.response.status_code


def put_scan(client, stamp):
    client.put("scan/fused", scan([1.5, np.inf, np.nan], stamp, intensities=np.array([2, 0, 0], "<f4").tobytes()))


@pytest.fixture
def client(network):
    return network.another()


@pytest.fixture
def view(network):
    return network.view


@pytest.fixture
def page(client, view):
    with Page(view.port, client.robot) as made:
        yield made


def test_two_packets_are_on_the_way_and_the_newest_scan_wins(client, page):
    seen = client.session.declare_publisher(f"{client.robot}/scan/fused")
    deadline = time.monotonic() + DEADLINE
    while not seen.matching_status.matching:  # it looks, so it receives
        assert time.monotonic() < deadline
    first = [page.receive(acknowledge=False), page.receive(acknowledge=False)]
    for number in range(30):
        put_scan(client, STAMP + number)
        with pytest.raises(TimeoutError):
            page.receive(timeout=0.01)
    with pytest.raises(TimeoutError):
        page.receive(timeout=QUIET)
    for packet in first:
        page.send(ack=packet["number"])
    drawn = page.until(lambda packet: packet["kind"] == "scene")
    assert drawn["stamp"] == STAMP + 29
    assert drawn["ranges"].tolist() == [1500, 65535, 0]
    assert drawn["evidence"].tolist() == [2, 0, 0]
    page.socket.close()
    while seen.matching_status.matching:  # nobody looks any more, so nothing travels
        assert time.monotonic() < deadline


def test_what_is_malformed_costs_nothing_else(client, page):
    page.until(lambda packet: packet["kind"] == "state" and packet["connected"])
    for _ in range(3):  # the last state was made after the first of them came
        for path in ("scan/fused", "camera/depth", "base/odom", "base/state", "base/safety", "map"):
            for payload in (b"", b"\xc1", b"\x80", msgpack.packb({"stamp": STAMP})):
                client.put(path, payload)
        page.until(lambda packet: packet["kind"] == "state")
    deadline = time.monotonic() + DEADLINE
    while (packet := page.receive())["kind"] != "scene":
        assert time.monotonic() < deadline
        put_scan(client, STAMP)
    assert packet["stamp"] == STAMP


def test_the_stop_button_stops_the_base_of_the_robot_on_the_page(client, page):
    asked = []

    def answer(query):
        asked.append(str(query.key_expr))
        query.reply(query.key_expr, msgpack.packb({"ok": True, "message": "stopped"}))

    client.session.declare_queryable(f"{client.robot}/base/command/**", answer)
    page.until(lambda packet: packet["kind"] == "state" and packet["connected"])
    for name in ("stop", "clear_safety"):
        told = {"text": "NO ANSWER"}
        while "NO ANSWER" in told["text"]:  # which a busy machine does not give in time
            page.send(ask=name, robot=client.robot)
            told = page.until(lambda packet: packet["kind"] == "answer")
        assert (told["ask"], told["text"]) == (name, f"{name}: done, stopped")
    page.send(ask="stop", robot="somebody/else")
    told = page.until(lambda packet: packet["kind"] == "answer")
    assert "NO ANSWER from the base of somebody/else" in told["text"]
    count = len(asked)
    assert set(asked) == {f"{client.robot}/base/command/{name}" for name in ("stop", "clear_safety")}
    page.send(ask="reset_odometry", robot=client.robot)  # the page has no button for it
    with pytest.raises(ConnectionClosed):
        page.until(lambda packet: packet["kind"] == "answer")
    assert len(asked) == count


def test_it_says_what_is_there_and_what_is_gone(client, page):
    page.send(watch="nobody")
    other = client.another()
    token = client.session.liveliness().declare_token(f"{other.robot}/alive/fuse")
    told = page.until(lambda packet: packet["kind"] == "state" and {"nobody", other.robot} <= {*packet["robots"]})
    assert (told["robot"], told["found"]) == ("nobody", False)
    assert "choose one" in told["notice"]
    page.send(watch=other.robot)
    told = page.until(lambda packet: packet["kind"] == "state" and packet["robot"] == other.robot and packet["found"])
    assert told["notice"] == ""
    token.undeclare()
    told = page.until(lambda packet: packet["kind"] == "state" and not packet["found"])
    assert "cliffscan up" in told["notice"]


def test_no_page_of_others_reads_it(view):
    assert refused(view.port, origin="http://evil.example") == 403
    assert refused(view.port, additional_headers={"Host": "evil.example"}) == 403
    status, _, text = get(view.port, Host="evil.example")
    assert (status, "is not this machine" in text) == (403, True)
    with opening(view.port, origin=f"http://127.0.0.1:{view.port}"):
        pass
    status, headers, text = get(view.port)
    assert (status, headers.get_content_type()) == (200, "text/html")
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]  # nor puts its button into a page
    for name in ("main.js", "style.css", "icon.svg"):
        assert f'"{name}"' in text
        assert get(view.port, f"/{name}")[0] == 200
    assert get(view.port, "/../server.py")[0] == 404
    with opening(view.port, protocol="something.else") as stranger, pytest.raises(ConnectionClosed) as closed:
        stranger.recv(timeout=DEADLINE)
    assert "foxglove.sdk.v1" in str(closed.value)


def test_beyond_this_machine_it_wants_the_token():
    view = View("--bind", "0.0.0.0", "--mode", "client", "--connect", "tcp/127.0.0.1:1")  # noqa: S104
    token = view.address.partition("?token=")[2]
    assert len(token) > 20
    assert get(view.port)[0] == 403
    assert get(view.port, f"/?token={token[:-1]}")[0] == 403
    assert get(view.port, f"/?token={token}")[0] == 200
    assert refused(view.port) == 403
    with opening(view.port, path=f"/socket?token={token}") as socket:
        assert socket.subprotocol == PROTOCOL
    view.end()
