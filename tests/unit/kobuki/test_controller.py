"""The base's controller, without a port: what goes to the base and when, and what is refused whatever was asked."""

import math
from collections import Counter

import numpy as np
import pytest

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.description import CameraDescription
from cliffscan.safety.message_gate import SILENT
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.controller import BaseController
from cliffscan.services.kobuki.protocol.commands import base_control
from cliffscan.simulator.kobuki.firmware import Firmware
from cliffscan.simulator.kobuki.kinematics import Wheels
from tests import build

TICK = 0.02  # [s]
SECOND = 1_000_000_000  # [ns]
STOP = base_control(0.0, 0.0)
CAMERA = CameraDescription(frame="camera", simulated=True, nearest_floor=0.7, farthest=4.5, field_of_view=(-0.5, 0.5))


class Robot:
    """A controller and the base's emulated firmware, in a time of their own, on an endless floor."""

    def __init__(self, simulated=True, **config):
        self.counts = Counter()
        self.controller = BaseController(KobukiConfig(**config), lambda what, _: self.counts.update([what]))
        self.controller.connect(simulated, 0.0)
        self.firmware, self.now, self.sent = Firmware(), 0.0, []

    @property
    def stamp(self):
        return round((1000.0 + self.now) * SECOND)

    @property
    def note(self):
        return self.controller.safety_state(self.stamp, self.now).note

    def command(self, linear, angular=0.0, late=0.0, **fields):
        stamp = self.stamp - round(late * SECOND)
        message = Velocity(stamp=stamp, linear=linear, angular=angular, **fields)
        self.controller.command(message, self.stamp, self.now)
        self.flush()

    def see(self, ranges=(math.inf,) * 40, ahead=0.0):
        scan = build.scan(ranges).model_copy(update={"stamp": self.stamp + round(ahead * SECOND)})
        self.controller.scan(scan, self.stamp, self.now)

    def flush(self):
        """What the controller wants to be written is obeyed by the base."""
        outputs = self.controller.take_outputs()
        self.sent += outputs
        for output in outputs:
            self.firmware.receive(output.data)

    def tick(self, linear=None, seconds=TICK, hear=True):
        for _ in range(round(seconds / TICK)):
            self.now += TICK
            if linear is not None:
                self.see()
                self.command(linear)
            said = self.firmware.step(TICK)
            if hear:
                list(self.controller.receive(said, self.stamp, self.now))
                self.controller.caught_up()
            self.controller.tick(self.now)
            self.flush()
        return self.controller.decision

    def moves(self):
        return [output for output in self.sent if output.data[2:4] == STOP[2:4] and output.data != STOP]


@pytest.fixture
def robot():
    made = Robot()
    made.tick(seconds=1.0)
    return made


def test_it_drives_and_then_stands(robot):
    assert robot.tick(0.3, 2.0).rule == "free"
    assert robot.firmware.drive.travelled.left > 0.2
    robot.tick(seconds=1.5)
    assert robot.controller.decision.rule == "no_command"
    assert robot.firmware.drive.speeds == Wheels(0.0, 0.0)


def test_commands_go_to_the_base_at_its_own_rate(robot):
    robot.tick(0.3, 2.0)
    robot.sent.clear()
    for _ in range(40):  # 2,000 in a second
        robot.command(0.3)
        robot.command(0.4)
    assert not robot.sent
    robot.tick(0.3)
    assert len(robot.sent) == 1


def test_a_command_that_slows_down_goes_at_once_and_once(robot):
    robot.tick(0.3, 2.0)
    robot.sent.clear()
    for _ in range(20):
        robot.command(0.1)
        robot.command(0.3)
    assert [output.data for output in robot.sent] == [base_control(0.1, 0.0)]
    robot.command(0.0)
    assert robot.sent[-1] == (STOP, True)
    robot.command(0.0)
    assert len(robot.sent) == 2


def test_a_stop_goes_before_what_waits_and_holds(robot):
    robot.tick(0.3, 2.0)
    robot.sent.clear()
    robot.controller.stop(robot.now)
    robot.flush()
    assert robot.sent == [(STOP, True)]
    robot.sent.clear()
    assert robot.tick(0.3, 1.0).rule == "stopped"
    assert not robot.moves()


@pytest.mark.parametrize("late", [10.0, -3600.0])
def test_a_command_of_another_time_moves_nothing(robot, late):
    robot.sent.clear()
    for _ in range(20):
        robot.see()
        robot.command(0.3, late=late)
        decision = robot.tick()
    assert decision.rule == "no_command"
    assert "this clock" in robot.note
    assert not robot.moves()


def test_a_burst_after_an_outage_moves_nothing(robot):
    robot.tick(0.3, 2.0)
    robot.tick(seconds=1.6)
    robot.sent.clear()
    for late in np.arange(1.56, 0.52, -0.04):
        robot.see()
        robot.command(0.3, late=late)
    robot.tick()
    assert not robot.moves()
    assert robot.counts["command_refused"] == 26


def test_a_base_that_repeats_a_packet_is_silent(robot):
    robot.tick(0.3, 2.0)
    packet, before = robot.firmware.step(TICK), robot.controller.alive_at
    rules = []
    for _ in range(40):
        robot.now += TICK
        robot.see()
        robot.command(0.3)
        assert not any(
            robot.controller.alive_at > before + TICK for _ in robot.controller.receive(packet, 0, robot.now)
        )
        robot.controller.tick(robot.now)
        rules.append(robot.controller.decision.rule)
    assert rules.index("no_base") <= round((SILENT + 2 * TICK) / TICK)
    assert set(rules[rules.index("no_base") :]) == {"no_base"}


def test_encoders_that_stand_still_stop_the_robot_until_somebody_clears_it(robot):
    robot.tick(0.3, 2.0)
    robot.firmware.encoders.count(Wheels(0.0, 0.0), robot.firmware.drive.travelled)
    true = robot.firmware.drive.pose.x
    assert robot.tick(0.3, 2.0).rule == "odometry"
    assert robot.firmware.drive.pose.x - true < 0.3
    robot.firmware.encoders.count(Wheels(1.0, 1.0), robot.firmware.drive.travelled)
    assert robot.tick(0.3, 1.0).rule == "odometry"
    robot.controller.requests()["clear_safety"]({})
    assert robot.tick(0.3, 1.0).rule == "free"


def test_encoders_that_leap_within_our_time_are_no_motion(robot):
    robot.tick(0.3, 2.0)
    robot.firmware.encoders.count(Wheels(20.0, 20.0), robot.firmware.drive.travelled)
    began, end = robot.controller.decision, 0.0
    for _ in range(5):  # 480 ms of the base's clock in 20 ms of ours
        robot.firmware.skip(0.46)
        for report in robot.controller.receive(robot.firmware.step(TICK), robot.stamp, robot.now):
            end = report.estimate.pose[0]
        robot.now += TICK
    assert began.rule == "free"
    assert end - 0.55 < 0.3
    assert robot.controller.decision.rule == "odometry"


def test_packets_that_were_late_are_motion_as_before(robot):
    robot.tick(0.3, 2.0)
    waited = b"".join(robot.firmware.step(TICK) for _ in range(20))
    robot.now += 0.4
    reports = list(robot.controller.receive(waited, robot.stamp, robot.now))
    assert [report.estimate.new_baseline for report in reports] == [None] * 20
    assert robot.tick(0.3, 0.5).rule in ("free", "limit")


def test_a_scan_of_the_future_holds_no_honest_one_up(robot):
    robot.see(ahead=0.09)
    assert robot.counts["scan_refused"] == 1
    for _ in range(50):
        robot.see(ahead=0.09)
        robot.see((0.8,) * 40)
        robot.command(0.6)
        decision = robot.tick()
    assert decision.rule == "obstacle"
    assert "obstacle ahead" in robot.note


def test_a_real_base_is_not_driven_by_a_simulated_camera():
    robot = Robot(simulated=False)
    robot.controller.describe(CAMERA.model_copy(update={"simulated": False}))
    robot.tick(seconds=1.0)
    assert robot.tick(0.3, 1.0).rule == "free"
    robot.controller.describe(CAMERA)
    robot.sent.clear()
    decision = robot.tick(0.3, 0.5)
    assert (decision.rule, decision.allowed) == ("refused", (0.0, 0.0))
    assert "camera is simulated" in robot.note
    assert not robot.moves()
    robot.controller.describe(CAMERA.model_copy(update={"simulated": False}))
    assert robot.tick(0.3, 1.0).rule == "free"


def test_an_emulated_base_may_be(robot):
    robot.controller.describe(CAMERA)
    assert robot.tick(0.3, 1.0).rule == "free"
