"""Encoders that stand still, run away or contradict the gyro are not driven by; those of a slow base are."""

import math

import pytest

from cliffscan.safety.odometry_monitor import DRIVEN, OdometryMonitor

WHEEL_SEPARATION = 0.23  # [m]
TICK = 0.02  # [s]
DEAD, RAMP = 0.2, 0.6  # [s], [m/s²] of a base that obeys late and brakes weakly


class Wheels:
    """A base that does what it is told late, and encoders that count a share of it."""

    def __init__(self):
        self.monitor, self.now = OdometryMonitor(WHEEL_SEPARATION), 100.0
        self.told, self.speeds, self.ways, self.gyro = [], [0.0, 0.0], [0.0, 0.0], 0.0
        self.shares, self.gyro_share = [1.0, 1.0], 1.0

    def drive(self, linear, angular, seconds):
        """Everything that the monitor says while the base is sent this."""
        said = []
        for _ in range(round(seconds / TICK)):
            self.now += TICK
            half = angular * WHEEL_SEPARATION / 2
            self.told.append((self.now, (linear - half, linear + half)))
            wanted = [each for at, each in self.told if at <= self.now - DEAD]
            for wheel in (0, 1):
                goal = wanted[-1][wheel] if wanted else 0.0
                change = max(-RAMP * TICK, min(RAMP * TICK, goal - self.speeds[wheel]))
                self.speeds[wheel] += change
                self.ways[wheel] += self.shares[wheel] * self.speeds[wheel] * TICK
            self.gyro += self.gyro_share * (self.speeds[1] - self.speeds[0]) / WHEEL_SEPARATION * TICK
            self.monitor.read(self.now, *self.ways, self.gyro)
            reasons = self.monitor.stuck(self.now), self.monitor.runaway(self.now), self.monitor.contradicted()
            said += [(self.now, why) for why in reasons if why]
            self.monitor.send(linear, angular, self.now)
        return said


@pytest.fixture
def wheels():
    return Wheels()


@pytest.mark.parametrize("speed", [0.05, 0.2, 0.5, 0.7])
def test_wheels_that_obey_late_are_believed(wheels, speed):
    for linear, angular in ((speed, 0.0), (-speed, 0.0), (speed, 0.5), (0.0, 1.9), (0.0, -1.9), (0.0, 0.0)):
        assert not wheels.drive(linear, angular, 3.0)


@pytest.mark.parametrize("wheel", [0, 1])
@pytest.mark.parametrize("speed", [0.1, 0.5])
def test_an_encoder_that_stands_still_while_it_drives_is_noticed_at_once(wheels, wheel, speed):
    assert not wheels.drive(speed, 0.0, 3.0)
    wheels.shares[wheel] = 0.0
    began = wheels.now
    said = wheels.drive(speed, 0.0, 1.0)
    assert said[0][0] - began < 0.2
    assert ("left", "right")[wheel] in said[0][1]
    assert "stands still" in said[0][1]


def test_a_wheel_that_never_starts_is_noticed_within_half_a_second_of_commands(wheels):
    wheels.shares = [0.0, 0.0]
    began = wheels.now
    said = wheels.drive(0.3, 0.0, 2.0)
    assert "stands still" in said[0][1]
    assert said[0][0] - began < DRIVEN + 0.1


def test_commands_that_the_guard_may_have_stopped_are_not_judged(wheels):
    assert not wheels.drive(0.3, 0.0, 2.0)
    wheels.speeds = [0.0, 0.0]
    wheels.now += 1.0  # the service hung, and the base was stopped
    wheels.told = []
    assert not wheels.drive(0.3, 0.0, 0.5)


def test_a_base_that_goes_on_after_the_command_has_changed_is_noticed(wheels):
    assert not wheels.drive(0.5, 0.0, 2.0)
    before = wheels.speeds[:]
    said = []
    for _ in range(100):
        wheels.speeds = before[:]
        wheels.told = [(wheels.now - 1.0, tuple(before))]
        said += wheels.drive(0.1, 0.0, TICK)
    assert "turns at 0.50 m/s and was commanded 0.10 m/s at most" in said[0][1]


@pytest.mark.parametrize("shares", [(0.5, 1.0), (1.0, 0.5)])
def test_half_an_encoder_contradicts_the_gyro(wheels, shares):
    assert not wheels.drive(0.5, 0.0, 2.0)
    wheels.shares = list(shares)
    said = wheels.drive(0.5, 0.0, 3.0)
    assert "by the gyro 0" in said[0][1]


def test_a_tenth_of_slip_on_the_spot_does_not(wheels):
    wheels.gyro_share = 0.9
    assert not wheels.drive(0.0, math.radians(110), 3.0)
