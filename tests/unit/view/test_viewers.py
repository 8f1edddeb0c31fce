"""What goes wrong for a viewer costs one message, and one that left is followed no more."""

import json
import threading
import time
from types import SimpleNamespace

import pytest

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.view.foxglove import FoxgloveClient
from cliffscan.view.foxglove_channels import channels
from cliffscan.view.robot_view import RobotView, Told
from cliffscan.view.robots import Robots
from cliffscan.view.viewer import Viewer
from tests.build import Bus, Stop, odometry_fields

DEADLINE = 60.0  # [s]
ODOM = next(number for number, channel in enumerate(channels(), start=1) if channel.topic == "/odom")


class Connection:
    """A socket that says a few things, and is then open until it is closed."""

    def __init__(self, *said):
        self._said = said
        self._closed = threading.Event()
        self.sent = []
        self.sent_some = threading.Semaphore(0)

    def __iter__(self):
        yield from map(json.dumps, self._said)
        self._closed.wait(DEADLINE)

    def send(self, message):
        self.sent.append(message)
        self.sent_some.release()

    def close(self):
        self._closed.set()


def serving(client):
    thread = threading.Thread(target=client.run, daemon=True)
    thread.start()
    return thread


def test_a_state_that_cannot_be_made_is_not_the_last_one():
    states = iter([RuntimeError("dictionary changed size during iteration"), {"kind": "state"}])

    def state(_view, _robot):
        made = next(states)
        if isinstance(made, Exception):
            raise made
        return made

    looks = []

    def watch(look):
        looks.append(look)
        return looks.clear

    robots = SimpleNamespace(preferred="turtlebot", view=lambda _robot: None, state=state, watch=watch)
    connection = Connection()
    thread = serving(Viewer(connection, robots))
    deadline = time.monotonic() + DEADLINE
    while not connection.sent_some.acquire(timeout=0.01):
        assert time.monotonic() < deadline
        for look in looks:
            look()
    connection.close()
    thread.join(DEADLINE)
    assert b'"kind": "state"' in connection.sent[0]


def test_a_sample_that_cannot_be_converted_is_not_the_last_one():
    received, listening = {}, threading.Event()

    def listen(topic, receive):
        received[topic.path] = receive
        listening.set()
        return received.clear

    connection = Connection({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": ODOM}]})
    thread = serving(FoxgloveClient(connection, SimpleNamespace(robot="turtlebot", listen=listen)))
    for _ in ("serverInfo", "advertise"):
        assert connection.sent_some.acquire(timeout=DEADLINE)
    assert listening.wait(DEADLINE)
    tried = threading.Event()

    class Bad:
        @property
        def message(self):
            tried.set()
            raise RuntimeError("deque mutated during iteration")

    received["base/odom"](Bad())
    assert tried.wait(DEADLINE)
    received["base/odom"](SimpleNamespace(message=Odometry.of(odometry_fields())))
    assert connection.sent_some.acquire(timeout=DEADLINE)
    connection.close()
    thread.join(DEADLINE)
    assert isinstance(connection.sent[-1], bytes)


def test_a_viewer_that_left_while_all_were_looked_at_is_not_joined_again():
    joined, looks = [], []
    view = SimpleNamespace(join=joined.append, leave=joined.remove, state=dict)

    def watch(look):
        looks.append(look)
        return lambda: None

    robots = SimpleNamespace(preferred="turtlebot", view=lambda _robot: view, watch=watch)
    connection = Connection()
    connection.close()
    Viewer(connection, robots).run()
    looks[0]()
    assert joined == []


class AfterTurns(Stop):
    """Set after some turns."""

    def __init__(self, turns):
        super().__init__()
        self._turns = turns

    def wait(self, timeout=None):
        self._turns -= 1
        if self._turns == 0:
            self.set()
        return super().wait(timeout)


def test_the_robots_are_looked_at_again_after_an_error():
    stop = AfterTurns(2)
    robots = Robots("turtlebot", "here")
    looked = []

    def fail():
        looked.append("first")
        raise RuntimeError("dictionary changed size during iteration")

    robots.watch(fail)
    robots.watch(lambda: looked.append("second"))
    robots.run(stop)
    assert looked == ["first", "second"] * 2


class Meanwhile:
    """Something that is looked at while a thread does more."""

    def __init__(self, more):
        self._more = more

    def __rsub__(self, _now):
        self._more()
        return 99.0  # [s]

    @property
    def pose(self):
        self._more()
        return (0.0, 0.0, 0.0)


@pytest.fixture
def view():
    return RobotView(Bus(), "turtlebot")


def test_what_comes_while_it_is_looked_for_is_no_error(view):
    view._last["scan"] = Told(None, Meanwhile(lambda: view._last.setdefault("base", Told(None, 0.0))))
    assert not view.found


def test_a_pose_that_comes_while_the_state_is_made_is_no_error(view):
    view._poses[""] = Meanwhile(lambda: view._poses.setdefault("plugin", None))
    assert view.state()["poses"] == {"": (0.0, 0.0, 0.0)}
