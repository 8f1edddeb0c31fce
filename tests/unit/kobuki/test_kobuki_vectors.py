"""The same as the reference driver on recorded streams, and more where that driver is known to lose packets.

The vectors lie beside the checkout and are no part of it.
"""

import json
import math
from pathlib import Path

import pytest

from cliffscan.services.kobuki import battery
from cliffscan.services.kobuki.kinematics import speed_and_radius
from cliffscan.services.kobuki.odometry import Odometry
from cliffscan.services.kobuki.odometry_increment import Reading, increment_between
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.commands import LedColour, Outputs, SoundSequence, Supply
from cliffscan.services.kobuki.protocol.frames import FrameParser, frame
from cliffscan.services.kobuki.protocol.packets import CENTIDEGREE, decode
from cliffscan.services.kobuki.protocol.sensors import VOLTS_PER_COUNT, Gains, GainSet
from cliffscan.services.kobuki.protocol.versions import UNREPORTED, Version, advice, refusal

CHECKOUT = Path(__file__).resolve().parents[3]
FILE = CHECKOUT.parent / "shared" / "data" / "kobuki_vectors.json"
if not FILE.exists():
    pytest.skip(f"the recorded vectors are not there: no {FILE}", allow_module_level=True)
VECTORS = json.loads(FILE.read_text())

ROUNDED = 1e-6  # by which the vectors' figures are rounded, relatively
HALF_A_STEP_SIDEWAYS = 1.2e-7  # [m]: the reference goes on in the direction from before the turn


def entries(kind):
    return [pytest.param(each, id=each.get("name") or each["in"]) for each in VECTORS[kind]]


def payloads_of(*writes):
    parser = FrameParser()
    return [payload for write in writes for payload in parser.feed(bytes.fromhex(write))]


def latest(feedbacks):
    """The newest of each field, as a driver that keeps them has it."""
    fields = {}
    for feedback in feedbacks:
        fields |= {name: value for name, value in feedback._asdict().items() if value is not None}
    return fields


def check_core(core, expected):
    found = core._asdict() | {"battery": round(10 * core.battery)}
    names = {"time_stamp": "timestamp", "over_current": "overcurrent"}
    assert {name: int(found[names.get(name, name)]) for name in expected} == expected


def check_sensors(found, expected):
    check_core(found["core"], expected["core"])
    if "inertia" in found:
        angles = expected["inertia"]["angle"], expected["inertia"]["angle_rate"]
        assert found["inertia"] == pytest.approx(tuple(angle * CENTIDEGREE for angle in angles))
        assert found["inertia"].rate == pytest.approx(expected.get("angular_velocity", found["inertia"].rate), abs=1e-9)
    for name, scale in (("dock_ir", 1), ("cliff", 1), ("current", 0.01)):
        if name in found and name in expected:
            assert found[name] == pytest.approx([scale * value for value in expected[name]])
    if "gp_input" in found:
        digital, analog = expected["gp"]["digital"], expected["gp"]["analog"]
        assert found["gp_input"].digital == tuple(bool(digital & 1 << bit) for bit in range(4))
        assert found["gp_input"].analog == pytest.approx([count * VOLTS_PER_COUNT for count in analog])


def check_gyro(gyro, expected):
    raw = expected["raw"]
    assert gyro.frame_id == expected["frame_id"]
    assert 3 * len(gyro.samples) == expected["len"]
    digit = math.radians(0.00875)
    for sample, x, y, z in zip(gyro.samples, raw[::3], raw[1::3], raw[2::3], strict=True):
        assert sample == pytest.approx((-y * digit, x * digit, z * digit))
    for sample, rates in zip(gyro.samples, expected.get("rad_s_robot_frame", []), strict=False):
        assert sample == pytest.approx(tuple(rates), abs=1e-8)


def check_battery(core, expected):
    full = battery.full_voltage(core)
    assert core.battery == pytest.approx(expected["voltage"])
    assert battery.percentage(core.battery, full) == pytest.approx(expected["percent"], rel=ROUNDED)
    state = "Charging" if core.charger.charging else "Charged" if core.charger.charged else "Discharging"
    assert state == expected["state"]
    assert core.charger.name.split("_")[0].title() == (
        expected["source"] if expected["source"] != "None" else "Discharging"
    )


@pytest.mark.parametrize("vector", entries("feedback"))
def test_feedback(vector):
    feedbacks = [decode(payload) for payload in payloads_of(*vector["packets"])]
    expected = vector["decoded_after_last"]
    found = latest(feedbacks)
    assert len(feedbacks) == len(vector["packets"])
    assert not any(feedback.skipped for feedback in feedbacks)
    check_sensors(found, expected)
    check_battery(found["core"], expected["battery"])
    if "gyro" in found:
        check_gyro(found["gyro"], expected["gyro"])
    for version in vector["version"]:
        assert (str(found["hardware"]), str(found["firmware"])) == (version["hardware"], version["firmware"])
        assert str(found["udid"]) == version["udid"]
    for gains in vector["controller"]:
        assert found["gains"] == (gains["type"], gains["p"] / 1000, gains["i"] / 1000, gains["d"] / 1000)


@pytest.mark.parametrize("vector", entries("feedback"))
def test_steps_by_the_wheels(vector):
    cores = [decode(payload).core for payload in payloads_of(*vector["packets"])]
    if len(cores) < 2:
        return
    before, after = (Reading.of(core, None, 0.0) for core in cores[-2:])
    step = increment_between(before, after)
    along, sideways, turn = vector["decoded_after_last"]["pose_update"]
    assert (step.distance, 0.0, step.turn) == pytest.approx((along, sideways, turn), rel=ROUNDED)
    rates = (step.distance / step.seconds, 0.0, step.turn / step.seconds)
    assert rates == pytest.approx(tuple(vector["decoded_after_last"]["rates"]), rel=ROUNDED)


def test_a_real_robot():
    capture = VECTORS["real_robot_captures"]
    by_wheels, by_gyro = Odometry(), Odometry()
    for n, (payload, expected) in enumerate(zip(payloads_of(*capture["packets"]), capture["decoded"], strict=True)):
        feedback = decode(payload)
        check_sensors(feedback._asdict(), expected)
        check_gyro(feedback.gyro, expected["gyro"])
        check_battery(feedback.core, expected["battery"])
        pose = by_wheels.update(feedback.core, None, 0.02 * n).pose
        assert pose == pytest.approx(tuple(expected["pose"]), rel=ROUNDED, abs=HALF_A_STEP_SIDEWAYS)
        heading = by_gyro.update(feedback.core, feedback.inertia, 0.02 * n).pose[2]
        assert heading == pytest.approx(expected["heading"], abs=1e-9)


MORE_THAN_THE_REFERENCE = {
    "truncated_then_good_one_write": 4,
    "split_packet_second_half_joined_with_next": 5,
    "header_only_then_good": 4,
    "overlong_length_255": 13,
    "gyro_30_samples_overflow": 3,
    "firmware_2_0_0": 4,
    "firmware_0_0_1": 4,
}


@pytest.mark.parametrize("vector", entries("malformed"))
def test_malformed_streams(vector):
    found = [frame(payload).hex() for payload in payloads_of(*vector["writes"])]
    remaining = iter(found)
    assert all(packet in remaining for packet in vector["accepted_packets"])
    assert len(found) == MORE_THAN_THE_REFERENCE.get(vector["name"], vector["accepted"])
    for packet in found:
        decode(bytes.fromhex(packet)[3:-1])


@pytest.mark.parametrize(
    ("name", "skipped", "stamps"),
    [
        ("payload_1_byte", [1], [40, None, 80]),
        ("payload_2_bytes", [1], [40, None, 80]),
        ("core_length_14", [1], [40, None, 80]),
        ("core_length_16", [1], [40, None, 80]),
        ("cliff_length_exceeds_rest", [5], [40, 60, 80]),
        ("gp_length_14", [16], [40, 60, 80]),
        ("unknown_id_99", [99], [40, 60, 80]),
        ("unknown_id_length_past_end", [99], [40, 60, 80]),
        ("gyro_length_mismatch", [13], [40, 60, 80]),
        ("gyro_8_samples_max", [], [40, 60, 80]),
        ("gyro_30_samples_overflow", [], [40, 60, 80]),
        ("firmware_len_3", [11], [40, 60, 80]),
        ("pre_1_0_0_real_capture", [], [40, None, 80]),
    ],
)
def test_what_is_wrong_costs_only_itself(name, skipped, stamps):
    (vector,) = (each for each in VECTORS["malformed"] if each["name"] == name)
    feedbacks = [decode(payload) for payload in payloads_of(*vector["writes"])]
    assert [feedback.core and feedback.core.timestamp for feedback in feedbacks] == stamps
    assert [each.id for feedback in feedbacks for each in feedback.skipped] == skipped
    if name.startswith("core_length"):
        assert feedbacks[1].cliff == (2050, 2060, 2070)
    if name == "pre_1_0_0_real_capture":
        assert feedbacks[1].firmware == UNREPORTED


def encoded(request, outputs):
    """The bytes of a request of the vectors, and the outputs after it."""
    name, *words = request.split()
    numbers = [float(word) for word in words]
    if name == "led":
        outputs = outputs.with_led(int(words[0]), LedColour(int(words[1])))
    elif name in ("dout", "ext"):
        mask, values = map(int, words)
        for bit in (bit for bit in range(4) if mask & 1 << bit):
            on = bool(values & 1 << bit)
            outputs = (
                outputs.with_digital_output(bit, on) if name == "dout" else outputs.with_supply(Supply(0x10 << bit), on)
            )
    else:
        return {
            "vel": lambda: commands.base_control(*numbers),
            "seq": lambda: commands.sound_sequence(SoundSequence(int(words[0]))),
            "version": commands.request_versions,
            "getgain": commands.get_gains,
            "setgain": lambda: commands.set_gains(
                Gains(GainSet(int(words[0])), *(number / 1000 for number in numbers[1:]))
            ),
        }[name](), outputs
    return outputs.encode(), outputs


def test_commands():
    outputs = Outputs()
    for vector in VECTORS["commands"]:
        request = vector["request"]
        if request == "dout 15 5":  # recorded by a driver started anew
            outputs = Outputs()
        if request.startswith("base"):  # speed and radius chosen at will, which this project has no command for
            continue
        found, outputs = encoded(request, outputs)
        assert found.hex() == vector["hex"], request
        if "speed" in vector:
            assert speed_and_radius(*map(float, request.split()[1:])) == (vector["speed"], vector["radius"])


@pytest.mark.parametrize("vector", entries("firmware_version_checks"))
def test_versions(vector):
    kind, code = vector["in"].split()
    number = int(code)
    version = Version(*map(int, vector["version"].split(".")))
    if kind == "fw2":
        assert decode(bytes([11, 2, number & 0xFF, number >> 8])).firmware == version
        return
    packed = bytes([11, 4, version.patch, version.minor, version.major, 0])
    assert decode(packed).firmware == version
    assert bool(refusal(version, None)) == bool(vector["major_check"])
    if not vector["major_check"]:
        assert bool(advice(version, None)) == bool(vector["recommended_check"])
