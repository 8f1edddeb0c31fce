"""The simulated robot drives as told, nods, bumps and falls as a real one, and always does the same for a seed."""

import math
from itertools import pairwise

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.simulator.kinect import kinect_camera
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.kobuki.kinematics import Wheels
from cliffscan.simulator.kobuki.sensors import DROP_ADC, FLOOR_ADC
from cliffscan.simulator.robot import RobotSimulation
from cliffscan.simulator.world import START, Pose
from tests.unit.kobuki_emulator.packets import drive, packets

LEFT, CENTRE, RIGHT = 4, 2, 1  # of bumpers and cliff sensors, as the protocol has them


def driven(world, linear, angular, seconds, pose=START, **options):
    simulation = RobotSimulation(world, pose, dead_time=0.0, **options)
    simulation.drive(linear, angular)
    simulation.step(seconds)
    return simulation


def first_times(simulation, seconds, **facts):
    """When each fact is true first [s]; inf = never."""
    times = dict.fromkeys(facts, math.inf)
    while simulation.time < seconds:
        simulation.step(0.01)
        for name, holds in facts.items():
            times[name] = min(times[name], simulation.time if holds() else math.inf)
    return times


def degrees(simulation):
    return math.degrees(simulation.floor().mount()[1])


def test_at_rest_the_camera_is_where_it_is_mounted():
    camera = kinect_camera(0.35, math.radians(10.0), math.radians(-2.0))
    simulation = driven("open_floor", 0.0, 0.0, 1.0, camera=camera)
    np.testing.assert_allclose(simulation.floor(), camera.floor, atol=5e-4)
    assert simulation.floor().mount()[1:] == pytest.approx(camera.floor.mount()[1:], abs=math.radians(0.02))
    assert simulation.pose == pytest.approx((0.0, 0.0, 0.0), abs=1e-4)


@pytest.mark.parametrize("speed", [0.1, 0.5, -0.3])
def test_it_drives_straight_as_told(speed):
    simulation = driven("open_floor", speed, 0.0, 4.0)
    ramp = abs(speed) / 2  # [s] that the motors' ramp costs
    assert simulation.pose == pytest.approx((speed * (4.0 - ramp), 0.0, 0.0), abs=0.02)
    left, right = simulation.base.wheels.travelled
    assert (left, right) == pytest.approx((simulation.pose.x, simulation.pose.x), abs=0.005)


@pytest.mark.parametrize("turn", [0.5, -1.5])
def test_it_turns_in_place(turn):
    simulation = driven("open_floor", 0.0, turn, 2.0)
    assert simulation.pose[:2] == pytest.approx((0.0, 0.0), abs=0.01)
    assert simulation.base.wheels.pose.theta == pytest.approx(2.0 * turn, rel=0.1)
    assert simulation.base.wheels.rates.yaw == pytest.approx(turn, rel=0.02)


def test_it_drives_a_circle():
    simulation = driven("open_floor", 0.3, 0.6, 2 * math.pi / 0.6 + 0.15)
    assert simulation.pose[:2] == pytest.approx((0.0, 0.0), abs=0.05)
    assert simulation.base.wheels.pose.theta == pytest.approx(2 * math.pi, rel=0.02)


def test_commands_take_their_time():
    simulation = RobotSimulation("open_floor")
    simulation.drive(0.2, 0.0)
    moving = first_times(simulation, 0.4, moving=lambda: simulation.base.wheels.speeds.left > 0.005)["moving"]
    assert moving == pytest.approx(0.21, abs=0.015)


def test_the_firmware_hears_and_tells_bytes():
    simulation = RobotSimulation("open_floor")
    said = simulation.step(2.0, drive(200))
    told = packets(said)
    assert len(told) == 100
    assert told[-1]["core"]["left"] * 0.0000852920904977 == pytest.approx(simulation.pose.x, abs=0.005)
    assert simulation.pose.x == pytest.approx(0.2 * 1.7, abs=0.02)


def test_the_camera_nods_down_when_braking_and_up_when_starting():
    simulation = RobotSimulation("open_floor", dead_time=0.0)
    simulation.drive(0.5, 0.0)
    nods = []
    for target in (0.5, 0.0):
        simulation.drive(target, 0.0)
        pitches = []
        for _ in range(120):
            simulation.step(0.01)
            pitches.append(degrees(simulation))
        nods.append(max(pitches, key=abs))
        assert pitches[-1] == pytest.approx(0.0, abs=0.1)
    assert -2.0 < nods[0] < -1.0
    assert 1.0 < nods[1] < 2.0


@pytest.mark.parametrize(
    ("yaw", "speed", "bumper"),
    [(0.0, 0.2, CENTRE), (0.6, 0.2, RIGHT), (-0.6, 0.2, LEFT), (math.pi, -0.2, 0)],
)
def test_a_push_closes_the_bumper_of_its_side(yaw, speed, bumper):
    simulation = RobotSimulation("empty_room", Pose(3.6, 0.0, yaw), dead_time=0.0)
    simulation.drive(speed, 0.0)
    while not simulation.bumped:
        simulation.step(0.01)
    assert simulation.base.firmware.sensors.bumper == bumper
    assert simulation.pose.x == pytest.approx(4.0 - 0.177, abs=0.005)
    assert simulation.base.bumps == 1
    assert not simulation.fallen


def test_a_bumper_does_not_flicker_while_the_robot_pushes():
    simulation = RobotSimulation("empty_room", Pose(3.7, 0.0), dead_time=0.0)
    simulation.drive(0.3, 0.0)
    states = []
    for _ in range(200):
        simulation.step(0.01)
        states.append(simulation.base.firmware.sensors.bumper)
    assert sum(before != after for before, after in pairwise(states)) == 1


def test_over_an_edge_cliffs_are_told_first_then_wheel_drops_then_it_has_fallen():
    simulation = RobotSimulation("paper_room", Pose(1.0, 0.1), dead_time=0.0)
    simulation.drive(0.3, 0.0)
    sensors = simulation.base.firmware.sensors
    times = first_times(
        simulation,
        4.0,
        centre=lambda: sensors.cliff & CENTRE,
        sides=lambda: sensors.cliff == LEFT | CENTRE | RIGHT,
        dropped=lambda: sensors.wheel_drop == 3,
        fallen=lambda: simulation.fallen,
    )
    assert times["centre"] == pytest.approx((0.5 - 0.156) / 0.3 + 0.15, abs=0.05)
    assert sorted(times, key=times.get) == ["centre", "sides", "dropped", "fallen"]
    assert times["fallen"] < 3.0
    simulation.place(Pose())
    simulation.drive(0.0, 0.0)
    simulation.step(0.5)
    assert not simulation.fallen
    assert (sensors.cliff, sensors.wheel_drop) == (0, 0)


def test_a_cliff_is_told_on_its_side_with_its_reading():
    """Along the hole's left side, so near that the right sensor looks into it."""
    simulation = driven("paper_room", 0.0, 0.0, 0.1, Pose(2.5, 1.125))
    sensors = simulation.base.firmware.sensors
    assert sensors.cliff == RIGHT
    assert sensors.cliff_adc["right"] == pytest.approx(DROP_ADC, abs=20)
    assert sensors.cliff_adc["left"] == pytest.approx(FLOOR_ADC, abs=20)
    assert not simulation.fallen


def test_it_stops_short_of_falling_when_it_is_stopped_in_time():
    simulation = driven("paper_room", 0.3, 0.0, 1.0, Pose(1.0, 0.0))
    simulation.drive(0.0, 0.0)
    simulation.step(2.0)
    assert not simulation.fallen
    assert simulation.pose.x < 1.45


def test_it_drives_over_the_ramps():
    simulation = driven("office", 0.3, 0.0, 7.0, Pose(2.0, -2.1))
    highest = simulation.base.body.position[2]
    assert highest == pytest.approx(0.105, abs=0.003)
    simulation.step(9.0)
    assert simulation.pose[:2] == pytest.approx((6.7, -2.1), abs=0.1)
    assert simulation.base.body.position[2] == pytest.approx(0.0, abs=0.01)
    assert simulation.bumped is simulation.fallen is False


def test_it_falls_down_the_kerb():
    simulation = driven("office", 0.3, 0.0, 6.0, Pose(-0.3, -0.5, -math.pi / 2))
    assert simulation.fallen


def test_the_kinect_sees_from_behind_the_wheels():
    simulation = driven("empty_room", 0.0, 0.0, 0.1, Pose(1.0, 0.0))
    assert simulation.viewpoint() == pytest.approx((0.913, 0.0, 0.0), abs=1e-4)
    assert simulation.depth()[240, 320] == pytest.approx(4.0 - 0.913, abs=0.002)


def test_the_same_seed_gives_the_same_drive_and_the_same_frames():
    def story(seed):
        simulation = driven("random:3", 0.3, 0.4, 1.0, seed=seed, wheels=WheelModel(noise=0.01))
        return simulation.pose, simulation.base.wheels.travelled, simulation.frame().tobytes()

    assert story(1) == story(1)
    assert story(1)[1:] != story(2)[1:]


def test_slip_noise_shows_in_the_encoders_alone():
    quiet = driven("open_floor", 0.3, 0.0, 2.0)
    noisy = driven("open_floor", 0.3, 0.0, 2.0, wheels=WheelModel(noise=0.02), seed=5)
    assert noisy.pose == quiet.pose
    assert 0.001 < abs(noisy.base.wheels.travelled.left - quiet.base.wheels.travelled.left) < 0.1


def test_a_share_of_slip_is_refused():
    with pytest.raises(ValueError, match="slip as their contacts do"):
        RobotSimulation("open_floor", wheels=WheelModel(slip=Wheels(0.1, 0.1)))


def test_an_impossible_camera_is_refused():
    camera = kinect_camera()
    with pytest.raises(ValueError, match="floor"):
        RobotSimulation(
            "open_floor", camera=camera.__class__(*list(vars(camera).values())[:4], FloorPlane(0, 0, -1, 1))
        )
