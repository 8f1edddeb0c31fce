"""The emulator against vectors of the reference driver and of real robots, where they are at hand."""

import json
import math
from pathlib import Path

import pytest

from cliffscan.simulator.kobuki import feedback
from cliffscan.simulator.kobuki.commands import decode
from cliffscan.simulator.kobuki.feedback import Gains
from cliffscan.simulator.kobuki.frames import FrameFinder, frame
from cliffscan.simulator.kobuki.kinematics import wheel_speeds
from cliffscan.simulator.kobuki.sensors import SIDES, Sensors
from cliffscan.simulator.kobuki.versions import Identity, Version
from tests.unit.kobuki_emulator.packets import decoded, payloads

VECTORS = Path(__file__).parents[4] / "shared/data/kobuki_vectors.json"

pytestmark = pytest.mark.skipif(
    not VECTORS.exists(), reason="kobuki_vectors.json is absent: it belongs into shared/data beside the checkout"
)
vectors = json.loads(VECTORS.read_text()) if VECTORS.exists() else {}


def of_kind(name):
    return vectors.get(name, [])


def encoded(told):
    """The packet that the emulator makes of decoded values."""
    core = told["core"]
    sensors = Sensors(
        bumper=core["bumper"],
        cliff=core["cliff"],
        wheel_drop=core["wheel_drop"],
        overcurrent=core["over_current"],
        button=core["buttons"],
        charger=core["charger"],
        battery=core["battery"] / 10,
        dock_ir=dict(zip(SIDES, told["dock_ir"], strict=True)),
        cliff_adc=dict(zip(SIDES, told["cliff"], strict=True)),
        current=dict(zip(("left", "right"), (value / 100 for value in told["current"]), strict=True)),
        digital_input=told["gp"]["digital"],
        analog_input=told["gp"]["analog"],
    )
    encoders = core["left_encoder"], core["right_encoder"]
    pwm = core["left_pwm"], core["right_pwm"]
    raw = told["gyro"]["raw"]
    return [
        feedback.core(core["time_stamp"], sensors, encoders, pwm),
        feedback.dock_ir(sensors),
        feedback.inertia(told["inertia"]["angle"], told["inertia"]["angle_rate"]),
        feedback.cliff(sensors),
        feedback.current(sensors),
        feedback.raw_gyro(told["gyro"]["frame_id"], [raw[n : n + 3] for n in range(0, len(raw), 3)]),
        feedback.inputs(sensors),
    ]


def usual(vector):
    """Whether its last packet holds what a base streams, in its order, and zeros in what is unused."""
    return len(vector["packets"][-1]) // 2 in (81, 87) and "order" not in vector["name"] and "gp" not in vector["name"]


@pytest.mark.parametrize("vector", [*filter(usual, of_kind("feedback"))], ids=lambda vector: vector["name"])
def test_a_packet_of_the_same_values_has_the_same_bytes(vector):
    made = frame(feedback.payload(encoded(vector["decoded_after_last"])))
    assert made.hex() == vector["packets"][-1]


@pytest.mark.parametrize("number", range(3))
def test_a_real_robots_packet_has_the_same_bytes_but_for_the_unused_ones(number):
    captures = vectors["real_robot_captures"]
    made = frame(feedback.payload(encoded(captures["decoded"][number])))
    real = bytes.fromhex(captures["packets"][number])
    different = [place for place, (ours, theirs) in enumerate(zip(made, real, strict=True)) if ours != theirs]
    assert set(different) <= {*range(74, 81)}  # the inputs' unused words, and the checksum


def test_answers_are_those_of_a_real_robot():
    packets = {vector["name"]: vector["packets"][-1] for vector in of_kind("feedback")}
    udid = (97713968, 842422349, 1361404194)
    for name, version in (("version_reply_4_byte", "1.2.0"), ("version_reply_old_2_byte", "1.0.0")):
        identity = Identity(firmware=Version.parse(version), udid=udid)
        parts = [feedback.hardware(identity), feedback.firmware(identity), feedback.udid(identity)]
        assert feedback.payload(parts).hex() in packets[name]
    for name, gains in (
        ("controller_info_default", feedback.FACTORY_GAINS),
        ("controller_info_user", Gains(1, 90_000, 50, 1_500)),
    ):
        assert feedback.payload([feedback.controller(gains)]).hex() in packets[name]


def test_a_packet_before_1_0_0_is_laid_out_like_a_real_one():
    (vector,) = (vector for vector in of_kind("malformed") if vector["name"] == "pre_1_0_0_real_capture")
    real = payloads(bytes.fromhex(vector["writes"][1]))[0]
    sensors = Sensors(
        charger=22,
        battery=16.5,
        cliff_adc={"right": 0x066A, "centre": 0x0744, "left": 0x0672},
        current={"left": 0.0, "right": 0.0},
        digital_input=0x48,
        analog_input=4 * [4095],
    )
    parts = [
        feedback.old_core(feedback.core(0xA820, sensors, (0x32FD, 0x3CDE), (0, 0))),
        feedback.dock_ir(sensors),
        feedback.inertia(0x242F, -2),
        feedback.cliff(sensors),
        feedback.current(sensors),
        feedback.inputs(sensors),
    ]
    made = feedback.old_payload(parts)
    different = [place for place, (ours, theirs) in enumerate(zip(made, real, strict=True)) if ours != theirs]
    assert different == [24, 25, 26, 48, 49]  # the unused bytes of inertia and inputs


@pytest.mark.parametrize("vector", of_kind("commands"), ids=lambda vector: vector["request"])
def test_a_reference_drivers_command_is_understood(vector):
    (payload,) = FrameFinder().feed(bytes.fromhex(vector["hex"]))
    (command,) = decode(payload)
    name, *values = vector["request"].split()
    if name == "vel":
        assert (command.speed, command.radius) == (vector["speed"], vector["radius"])
        check_motion(command, *map(float, values))
    elif name in ("base", "setgain"):
        assert list(vars(command).values()) == [int(value) for value in values]
    else:
        kinds = {"led": "output", "dout": "output", "ext": "output", "seq": "sound_sequence"}
        assert command.name == {**kinds, "version": "request", "getgain": "get_gains"}[name]


def check_motion(command, forward, turn):
    """The wheels turn as the driver meant, as far as whole millimetres and the base's limits allow."""
    if abs(forward) > 0.7 or abs(turn) > math.pi:
        return
    speeds = wheel_speeds(command.speed, command.radius)
    assert (speeds.left + speeds.right) / 2 == pytest.approx(forward, abs=0.002)
    assert (speeds.right - speeds.left) / 0.23 == pytest.approx(turn, abs=0.02)


def test_the_tests_own_decoder_agrees_with_the_reference():
    vector = of_kind("feedback")[1]
    ours, theirs = decoded(payloads(bytes.fromhex(vector["packets"][-1]))[0]), vector["decoded_after_last"]
    assert list(ours["core"].values()) == list(theirs["core"].values())
    assert [value for sample in ours["samples"] for value in sample] == theirs["gyro"]["raw"]
    assert (ours["first"], ours["cliff"]) == (theirs["gyro"]["frame_id"], theirs["cliff"])
