"""What is made of the stops of a base: every one of them is covered by what is printed."""

import signal
import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan import calibrate_base
from cliffscan.calibrate import NotMeasured
from cliffscan.calibrate_base import Brakes, Stop, Track, brakes_of, fastest_on, lines, measure_base
from cliffscan.cli import build_parser
from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.topics import ODOMETRY
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.drive import FAREWELL

SPEEDS = (0.25, -0.25, 0.375, -0.375, 0.5, -0.5)


def stops(late, deceleration, errors=(0.0,) * 6):
    return [
        Stop(abs(v), abs(v) * late + v * v / (2 * deceleration) + error)
        for v, error in zip(SPEEDS, errors, strict=True)
    ]


@given(st.floats(0.02, 0.5), st.floats(0.3, 2.0), st.lists(st.floats(-0.003, 0.003), min_size=6, max_size=6))
def test_no_measured_stop_is_longer_than_the_gate_takes_it_for(late, deceleration, errors):
    measured = stops(late, deceleration, errors)
    try:
        brakes = brakes_of(measured)
    except NotMeasured:
        return
    for speed, way in measured:
        assert way <= speed * brakes.reaction + speed**2 / (2 * brakes.deceleration) + 1e-9


def test_exact_stops_give_the_base_they_are_of():
    brakes = brakes_of(stops(0.2, 0.8))
    assert brakes.deceleration == pytest.approx(0.76)
    assert 0.2 < brakes.reaction < 0.26


def test_ways_that_do_not_grow_are_no_measure():
    with pytest.raises(NotMeasured, match="drive faster"):
        brakes_of([Stop(0.25, 0.2), Stop(0.5, 0.2), Stop(0.75, 0.2)])


@given(st.floats(0.5, 5.0), st.floats(0.1, 2.0))
def test_a_slow_base_keeps_to_the_free_floor(free, most):
    speed = fastest_on(free, most)
    assert 0.0 < speed <= most
    assert speed**2 / (2 * 0.5) + speed * (0.3 + 0.35) + speed**2 / (2 * 0.4) <= free - 0.1 + 1e-9


def test_the_lines_are_rounded_to_the_safe_side():
    assert lines("gate", Brakes(0.2112, 0.7689), Brakes(0.1, np.radians(171.9))).splitlines() == [
        "[gate]",
        "deceleration = 0.76  # [m/s²]",
        "angular_deceleration = 171  # [deg/s²]",
        "reaction = 0.22  # [s] straight 0.21, turning 0.10",
    ]


@pytest.mark.parametrize(("words", "role"), [([], ""), (["--role", "driver"], "driver")])
def test_the_keys_follow_from_what_is_measured_unless_named(words, role):
    assert build_parser().parse_args(["calibrate", *words]).role == role


class FreeFloor:
    """A bus with a base that moves as it is told, and does something else when it first does."""

    robot = "turtlebot"

    def __init__(self, when_it_drives=None):
        self.linear = []  # [m/s] of all commands
        self._when_it_drives = when_it_drives
        self._x = 0.0  # [m]

    def subscribe(self, path, receive):
        if path == ODOMETRY.path:
            self._receive = receive
            self.publish()

    def publisher(self, _topic):
        return self

    def put(self, velocity):
        first = velocity.linear and not any(self.linear)
        self.linear.append(velocity.linear)
        self._x += velocity.linear * calibrate_base.PERIOD
        self.publish()
        if first:
            self._when_it_drives()

    def publish(self):
        """Publish where it is."""
        at = Odometry(
            stamp=time.time_ns(),
            frame="odom",
            child_frame="base_link",
            pose=(self._x, 0.0, 0.0),
            twist=(0.0, 0.0),
            pose_covariance=[0.0] * 9,
            twist_covariance=[0.0] * 9,
        )
        self._receive(ODOMETRY.path, at.encode())


@pytest.fixture
def signals():
    """Signals as they were; a hang-up that nobody heeds fails the test instead of ending it."""

    def kill(number, _frame):
        pytest.fail(f"{signal.Signals(number).name} kills it while the robot drives")

    numbers = (signal.SIGHUP, signal.SIGQUIT, signal.SIGTERM, signal.SIGINT)
    before = {number: signal.signal(number, kill) for number in numbers}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("signals")
@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGQUIT, signal.SIGTERM])
def test_a_signal_while_it_drives_commands_it_to_stand_several_times(number, monkeypatch, capsys):
    monkeypatch.setattr(calibrate_base, "_ask", lambda *_: None)
    bus = FreeFloor(lambda: signal.raise_signal(number))
    assert measure_base(bus, 1.5, 0.5, 1.0, StopSignal()) == 1
    assert len(bus.linear) == 1 + FAREWELL
    assert bus.linear[0] > 0.0
    assert set(bus.linear[1:]) == {0.0}
    assert "ended before all was measured" in capsys.readouterr().err


class WhileMoreComes:
    """A span of time without the first message; while that one is compared with its begin, another one comes."""

    def __init__(self, bus):
        self._bus = bus
        self._more = True

    def __rsub__(self, _now):
        return self

    def __le__(self, _then):
        if self._more:
            self._more = False
            self._bus.publish()
            return False
        return True


def test_odometry_that_comes_while_it_is_looked_at_ends_nothing():
    bus = FreeFloor()
    track = Track(bus)
    bus.publish()
    assert track.since("drive", WhileMoreComes(bus)) == 0.0
