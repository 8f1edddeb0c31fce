"""`cliffscan drive` on a terminal of its own: a pty, whose other end types and looks."""

import fcntl
import os
import queue
import select
import signal
import struct
import sys
import termios
import time

import msgpack
import pytest

from tests.service.conftest import DEADLINE
from tests.service.test_command import ask

UP, LEFT = b"\x1b[A", b"\x1b[D"
CONTROL_C = b"\x03"
ODOMETRY = {
    "stamp": 1,
    "frame": "odom",
    "child_frame": "base_link",
    "pose": [1.25, -0.5, 0.0],
    "twist": [0.18, 0.0],
    "pose_covariance": [0.0] * 9,
    "twist_covariance": [0.0] * 9,
}
SAFETY = {
    "stamp": 1,
    "rule": "obstacle",
    "distance": 0.62,
    "asked": [0.2, 0.0],
    "allowed": [0.07, 0.0],
    "latched": False,
    "note": "",
}


class Typist:
    """Sits at the terminal."""

    def __init__(self) -> None:
        self.hand, self.end = os.openpty()
        fcntl.ioctl(self.end, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
        self.before = termios.tcgetattr(self.end)
        self.seen = b""

    def type(self, keys):
        os.write(self.hand, keys)

    def wait_seen(self, text, meanwhile=lambda: None):
        """Look until `text` is shown, from here on; do something between two looks."""
        self.seen = b""
        deadline = time.monotonic() + DEADLINE
        while text not in self.seen:
            meanwhile()
            ready, _, _ = select.select([self.hand], [], [], DEADLINE)
            assert ready, self.seen
            assert time.monotonic() < deadline, self.seen[-2000:]
            self.seen += os.read(self.hand, 65536)

    def hang_up(self):
        os.close(self.hand)
        self.hand = None

    def leave(self):
        os.close(self.end)
        if self.hand is not None:
            os.close(self.hand)


@pytest.fixture
def typist():
    made = Typist()
    yield made
    made.leave()


@pytest.fixture
def velocities(client):
    return client.listen("base/cmd_vel")


@pytest.fixture
def driving(client, run, typist, velocities):
    """The program, when it shows what it has to show."""
    place = ["--robot", client.robot, "--connect", client.endpoint]
    process = run([sys.executable, "-m", "tests.login", os.ttyname(typist.end), "drive", *place])
    typist.wait_seen(b"nothing received yet")
    return process


def forward(velocity):
    return velocity["linear"] > 0


def still(velocity):
    return velocity["linear"] == 0 and velocity["angular"] == 0


def assert_still(velocities, since):
    """Zero was said after `since` [ns], and nothing else after it."""
    velocities.until(lambda velocity: still(velocity) and velocity["stamp"] > since)
    assert all(still(velocity) for velocity in velocities.all())


def test_a_key_drives_and_its_release_stops_and_q_ends(typist, velocities, driving):
    typist.type(UP)
    first = velocities.until(forward)
    assert (first["linear"], first["angular"]) == (0.2, 0.0)
    assert first["stamp"] > 0
    velocities.until(still)
    now = time.time_ns()
    typist.type(b"q")
    assert driving.end() == 0
    assert_still(velocities, now)
    assert termios.tcgetattr(typist.end) == typist.before


def test_a_held_key_drives_until_it_is_released(typist, velocities, driving):
    typist.type(UP)
    for _ in range(20):
        heard = velocities.until(forward)
        typist.type(UP)
    assert velocities.until(still)["stamp"] > heard["stamp"]


def test_space_stops_and_a_new_speed_counts(typist, velocities, driving):
    typist.type(b"+" + UP + LEFT)
    arc = velocities.until(lambda velocity: velocity["angular"] > 0)
    assert (arc["linear"], arc["angular"]) == (0.25, 0.8)
    typist.type(b" ")
    velocities.until(still)


@pytest.mark.parametrize("how", ["control-c", "terminate", "hang up", "interrupt", "quit"])
def test_whatever_ends_it_while_driving_the_last_velocity_is_zero(typist, velocities, driving, how):
    typist.type(UP)
    driven = velocities.until(forward)
    if how == "control-c":
        typist.type(CONTROL_C)
    elif how == "hang up":
        typist.hang_up()
    else:
        driving.signal({"terminate": signal.SIGTERM, "interrupt": signal.SIGINT, "quit": signal.SIGQUIT}[how])
    assert driving.end() == 0
    assert_still(velocities, driven["stamp"])


def test_what_the_base_says_is_shown(client, typist, driving):
    def base():
        client.put("base/odom", ODOMETRY)
        client.put("base/safety", SAFETY)

    typist.wait_seen(b"x +1.250 m   y -0.500 m", base)
    typist.wait_seen(b"obstacle, 0.62 m to go", base)
    typist.wait_seen(b"STALE")  # now that the base is silent


def test_what_is_malformed_is_not_shown_and_ends_nothing(client, typist, driving):
    def base():
        client.put("base/odom", b"\xc1")
        client.put("base/safety", SAFETY | {"rule": 5})
        client.put("base/odom", ODOMETRY)

    typist.wait_seen(b"x +1.250 m   y -0.500 m", base)
    assert b"obstacle" not in typist.seen


@pytest.mark.parametrize(
    ("key", "command", "reply", "shown"),
    [
        (b"x", "stop", {"ok": True, "message": "stopped until clear_safety"}, b"stop: done, stopped until"),
        (b"c", "clear_safety", {"ok": False, "message": "a wheel hangs"}, b"clear_safety: REFUSED, a wheel hangs"),
        (b"r", "reset_odometry", {"ok": True, "message": "at zero"}, b"reset_odometry: done, at zero"),
        (b"r", "reset_odometry", [1], b"reset_odometry: malformed reply"),
    ],
)
def test_orders_are_given_and_the_answer_is_shown(client, typist, driving, key, command, reply, shown):
    asked = queue.Queue()

    def answer(query):
        with query:
            asked.put(msgpack.unpackb(query.payload.to_bytes()))
            query.reply(query.key_expr, msgpack.packb(reply))

    queryable = client.session.declare_queryable(f"{client.robot}/base/command/{command}", answer)

    def again():
        """It waits for a second, in which a busy machine may not answer."""
        if b"NO ANSWER" in typist.seen:
            typist.seen = b""
            typist.type(key)

    typist.type(key)
    assert asked.get(timeout=DEADLINE) == {}
    typist.wait_seen(shown, again)
    queryable.undeclare()


def test_a_base_that_does_not_answer_is_told(typist, driving):
    typist.type(b"x")
    typist.wait_seen(b"stop: NO ANSWER")


def test_without_a_terminal_it_says_so(client):
    refused = ask("drive", "--robot", client.robot, "--connect", client.endpoint)
    assert refused.returncode == 2
    assert refused.stderr == "cliffscan: drive: standard input is no terminal; over ssh, a terminal comes with -t\n"
