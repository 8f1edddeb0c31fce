"""What the emulated firmware streams: when, how much, and what it says about a moving base."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator.kobuki.drive import Pose, Rates
from cliffscan.simulator.kobuki.firmware import Firmware
from cliffscan.simulator.kobuki.kinematics import REST, Wheels
from tests.unit.kobuki_emulator.packets import command, drive, packets, payloads


class Scripted:
    """Wheels that a test moves by hand: what a physics simulator puts in the place of the emulator's own."""

    def __init__(self) -> None:
        self.travelled, self.speeds, self.pose, self.rates = REST, REST, Pose(), Rates()
        self.commanded = []

    def command(self, speeds):
        self.commanded.append(speeds)

    def release(self):
        self.commanded.append(None)

    def step(self, dt):
        self.last_step = dt


def run(firmware, seconds):
    return packets(firmware.step(seconds))


def test_fifty_packets_a_second_of_two_sizes():
    sizes = [len(payload) for payload in payloads(Firmware().step(10.0))]
    assert len(sizes) == 500
    assert set(sizes) == {77, 83}
    assert sizes.count(83) == 40  # the gyro has 1040 samples in that time


@given(st.lists(st.floats(0.0, 0.1), min_size=1, max_size=30))
def test_the_stream_does_not_depend_on_how_time_is_cut(steps):
    whole, cut = Firmware(), Firmware()
    for firmware in (whole, cut):
        firmware.receive(drive(200, 300))
    said = b"".join(cut.step(step) for step in steps)
    expected = whole.step(sum(round(step * 1e9) for step in steps) / 1e9)
    first, second = packets(said), packets(expected)
    assert [packet["core"]["stamp"] for packet in first] == [packet["core"]["stamp"] for packet in second]
    assert [packet["first"] for packet in first] == [packet["first"] for packet in second]
    for ours, theirs in zip(first, second, strict=True):
        assert abs(ours["core"]["right"] - theirs["core"]["right"]) <= 2


@pytest.mark.parametrize("span", [-0.1, math.nan, math.inf])
def test_time_only_goes_forward(span):
    with pytest.raises(ValueError, match="expected a span of 0 s or more"):
        Firmware().step(span)


def test_a_packet_at_rest_byte_by_byte():
    assert Firmware().step(0.02).hex() == (
        "aa554d"
        "010f14000000000000000000000000a400"  # core: 20 ms, all released, 16.4 V
        "0303000000"
        "040700000000000000"
        "0506020802080208"
        "06020101"
        "0d0e0006000000000000000000000000"
        "101000000000000000000000000000000000"
        "f8"
    )


def test_stamps_wrap_and_gyro_samples_are_counted_without_a_gap():
    told = run(Firmware(), 70.0)
    stamps = [packet["core"]["stamp"] for packet in told]
    assert stamps == [20 * n % 65536 for n in range(1, 3501)]
    for before, after in pairwise(told):
        assert after["first"] == (before["first"] + len(before["samples"])) % 256


def test_the_encoders_follow_the_wheels_and_wrap_in_both_directions():
    firmware = Firmware()
    firmware.receive(drive(-700))
    last = run(firmware, 12.0)[-1]["core"]
    expected = firmware.drive.travelled.left / 0.0000852920904977
    assert expected < -65536
    assert last["left"] == last["right"] == math.floor(expected) % 65536
    assert last["left_pwm"] == last["right_pwm"] == -126


def test_turning_shows_in_heading_rate_and_raw_samples():
    firmware = Firmware()
    firmware.receive(drive(115, 1))  # 1 rad/s to the left
    told = run(firmware, 5.0)
    angles = [packet["inertia"][0] for packet in told]
    assert max(angles) <= 18000
    assert min(angles) >= -18000
    heading = math.remainder(firmware.drive.pose.theta, math.tau)
    assert angles[-1] == pytest.approx(math.degrees(heading) * 100, abs=0.51)
    assert min(angles) < -17000 < 17000 < max(angles)  # it went through the back
    assert told[-1]["inertia"][1] == 5730
    assert told[-1]["samples"][-1] == (0, 0, 6548)


def test_the_gyro_stands_a_quarter_turn_from_the_robot():
    wheels = Scripted()
    wheels.rates = Rates(roll=math.radians(0.875), pitch=math.radians(1.75), yaw=math.radians(-400.0))
    told = run(Firmware(wheels), 0.02)[0]
    x, y, z = told["samples"][-1]
    assert (-y, x) == (100, 200)  # robot x = -raw y, robot y = raw x
    assert z == -32768  # beyond what the sensor can tell
    assert told["inertia"][1] == -32768


def test_wheels_of_another_make_are_commanded_and_read():
    wheels = Scripted()
    wheels.travelled, wheels.pose = Wheels(5.0, 6.0), Pose(1.0, 2.0, 3.0)
    firmware = Firmware(wheels, dead_time=0.0)
    firmware.receive(drive(257, 400))
    firmware.step(0.01)
    assert wheels.commanded[-1] == pytest.approx((0.143, 0.257), abs=0.001)
    wheels.travelled, wheels.pose = Wheels(5.1, 6.2), Pose(1.0, 2.0, 3.1)
    told = run(firmware, 0.01)[0]
    assert (told["core"]["left"], told["core"]["right"]) == (1172, 2344)  # counted from power-on
    assert told["inertia"][0] == 573


def test_the_sensors_are_told_where_the_protocol_has_them():
    firmware = Firmware()
    sensors = firmware.sensors
    for name, which in (("bumper", "left"), ("bumper", "right"), ("cliff", "centre"), ("wheel_drop", "left")):
        sensors.flag(name, which, on=True)
    sensors.flag("button", "2", on=True)
    sensors.charger, sensors.battery, sensors.digital_input = 22, 13.24, 0b1010
    sensors.dock_ir = {"left": 1, "centre": 2, "right": 32}
    sensors.cliff_adc |= {"left": 100, "right": 9999}
    sensors.current = {"left": 1.23, "right": 4.0}
    sensors.analog_input[3] = 4095
    told = run(firmware, 0.02)[0]
    core = told["core"]
    assert (core["bumper"], core["cliff"], core["wheel_drop"], core["button"]) == (5, 2, 2, 4)
    assert (core["charger"], core["battery"], core["overcurrent"]) == (22, 132, 0)
    assert told["dock_ir"] == [32, 2, 1]
    assert told["cliff"] == [4095, 310, 100]
    assert told["current"] == [123, 255]
    assert told["inputs"] == (0b1010, 0, 0, 0, 4095)
    sensors.flag("bumper", "left", on=False)
    assert run(firmware, 0.02)[0]["core"]["bumper"] == 1


def test_the_base_may_jump_in_time():
    firmware = Firmware()
    firmware.skip(40.0)
    assert run(firmware, 0.02)[0]["core"]["stamp"] == 40020


def test_garbage_among_the_commands_is_left_out_and_counted():
    firmware = Firmware()
    firmware.receive(b"\x01\x02\xaa" + drive(100) + b"\x55" + command(12, "<H", 0x02F0))
    assert firmware.discarded == 4
    assert firmware.received.count == {"base_control": 1, "output": 1}
