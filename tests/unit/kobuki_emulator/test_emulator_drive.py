"""From a command to wheel speeds, and from wheel speeds to a pose."""

import math

import pytest

from cliffscan.simulator.kobuki.drive import RampedWheels, WheelModel
from cliffscan.simulator.kobuki.kinematics import METRES_PER_TICK, Wheels, ticks, wheel_speeds

TICK = 0.005  # [s]
IMMEDIATE = 1e9  # [m/s²]


def motion(speeds):
    return (speeds.left + speeds.right) / 2, (speeds.right - speeds.left) / 0.23


@pytest.mark.parametrize(
    ("speed", "radius", "expected"),
    [
        (0, 0, (0.0, 0.0)),
        (100, 0, (0.1, 0.0)),
        (-100, 0, (-0.1, 0.0)),
        (115, 1, (0.0, 1.0)),  # on the spot, to the left
        (-115, 1, (0.0, -1.0)),
        (115, -1, (0.0, -1.0)),  # never sent by a good driver; taken for the mirror image
        (257, 400, (0.2, 0.5)),
        (-257, -400, (-0.2, 0.5)),
        (-257, 400, (-0.2, -0.5)),
        (445, -33, (0.1, -3.0)),
        (116, 2, (0.002, 1.0)),
        (500, 32767, (0.5, 0.015)),
        (2000, 0, (0.7, 0.0)),  # faster than it can
        (32767, 1, (0.0, math.pi)),
    ],
)
def test_a_command_is_a_motion(speed, radius, expected):
    assert motion(wheel_speeds(speed, radius)) == pytest.approx(expected, abs=0.01)


def test_an_encoder_counts_forward_and_back_and_wraps():
    assert ticks(0.1) == 1172
    assert ticks(-METRES_PER_TICK / 2) == 65535
    assert ticks(65536.5 * METRES_PER_TICK) == 0


def drive(wheels, speeds, seconds):
    wheels.command(Wheels(*speeds))
    for _ in range(round(seconds / TICK)):
        wheels.step(TICK)


def test_speed_changes_at_a_limited_rate():
    wheels = RampedWheels(WheelModel(acceleration=0.5, deceleration=2.0))
    drive(wheels, (0.4, 0.4), 0.4)
    assert wheels.speeds == pytest.approx((0.2, 0.2))
    drive(wheels, (0.4, 0.4), 0.4)
    assert wheels.speeds == pytest.approx((0.4, 0.4))
    assert wheels.travelled.left == pytest.approx(0.4 * 0.4 / 2 / 0.5)
    drive(wheels, (0.0, 0.0), 0.1)
    assert wheels.speeds == pytest.approx((0.2, 0.2))
    wheels.release()
    wheels.step(0.1)
    assert wheels.speeds == pytest.approx((0.0, 0.0))


def test_the_braking_way_is_that_of_its_deceleration():
    wheels = RampedWheels()
    drive(wheels, (0.5, 0.5), 2.0)
    before = wheels.pose.x
    drive(wheels, (0.0, 0.0), 2.0)
    assert wheels.pose.x - before == pytest.approx(0.5**2 / 2 / 1.0, abs=1e-6)


def test_a_full_circle_closes():
    wheels = RampedWheels(WheelModel(acceleration=IMMEDIATE))
    speeds = wheel_speeds(257, 400)
    turn = (speeds.right - speeds.left) / 0.23
    wheels.command(speeds)
    wheels.step(1e-9)  # to full speed
    for _ in range(1000):
        wheels.step(math.tau / turn / 1000)
    assert wheels.pose == pytest.approx((0.0, 0.0, math.tau), abs=1e-6)
    assert wheels.rates.yaw == pytest.approx(turn)
    assert wheels.travelled.right > wheels.travelled.left


def test_slipping_wheels_turn_further_than_the_base_goes():
    wheels = RampedWheels(WheelModel(slip=Wheels(0.1, 0.2)))
    drive(wheels, (0.2, 0.2), 5.0)
    assert wheels.travelled.left == wheels.travelled.right > 0.9
    assert wheels.pose.theta == pytest.approx(-0.1 * wheels.travelled.left / 0.23)


def test_noise_is_that_of_its_seed_and_does_not_depend_on_the_step():
    def end(seed, tick):
        wheels = RampedWheels(WheelModel(acceleration=IMMEDIATE, noise=0.02), seed)
        wheels.command(Wheels(0.5, 0.5))
        for _ in range(round(2.0 / tick)):
            wheels.step(tick)
        return wheels.pose

    assert end(1, TICK) == end(1, TICK) != end(2, TICK)
    for tick in (0.002, 0.02):
        errors = [end(seed, tick).x - 1.0 for seed in range(60)]
        assert math.sqrt(sum(error**2 for error in errors) / 60) == pytest.approx(0.02 / math.sqrt(2), rel=0.35)


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"acceleration": 0.0}, "acceleration of 0.0"),
        ({"deceleration": math.inf}, "deceleration of inf"),
        ({"noise": -1.0}, "noise of -1.0"),
        ({"slip": Wheels(0.0, 2.0)}, "slip of 0.0, 2.0"),
    ],
)
def test_a_model_that_means_nothing_is_refused(values, reason):
    with pytest.raises(ValueError, match=reason):
        WheelModel(**values)
