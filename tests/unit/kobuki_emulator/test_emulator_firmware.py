"""What the emulated firmware does when told."""

import struct

import pytest

from cliffscan.simulator.kobuki.drive import Pose
from cliffscan.simulator.kobuki.feedback import FACTORY_GAINS
from cliffscan.simulator.kobuki.firmware import Firmware
from cliffscan.simulator.kobuki.kinematics import REST
from cliffscan.simulator.kobuki.versions import Identity, Version
from tests.unit.kobuki_emulator.packets import command, drive, packets, payloads

VERSIONS = command(9, "<H", 11)
GET_GAINS = command(14, "<B", 0)


def of_version(text):
    return Firmware(identity=Identity(firmware=Version.parse(text)))


def answers(firmware):
    """What the next packet tells beyond what every packet does."""
    told = packets(firmware.step(0.02))[0]
    return {name: told[name].hex() for name in ("hardware", "firmware", "udid", "controller") if name in told}


def test_the_wheels_answer_after_the_dead_time():
    firmware = Firmware(dead_time=0.2)
    firmware.step(0.013)
    firmware.receive(drive(500))
    firmware.step(0.2)
    assert firmware.drive.pose == Pose()
    firmware.step(0.001)
    assert 0.0 < firmware.drive.speeds.left <= 0.0011


def test_the_last_command_holds_for_ever():
    firmware = Firmware()
    firmware.receive(drive(300))
    firmware.step(60.0)
    assert firmware.drive.speeds == pytest.approx((0.3, 0.3))
    firmware.receive(drive(0))
    firmware.step(1.0)
    assert firmware.drive.speeds == REST


def test_commands_are_obeyed_in_order_however_fast_they_come():
    firmware = Firmware(dead_time=0.1)
    for speed in (100, 200, -50):
        firmware.receive(drive(speed))
        firmware.step(0.01)
    firmware.step(0.0999)
    assert firmware.motors.target.left == -0.05


def test_a_stop_at_half_a_metre_a_second_takes_dead_time_and_braking_way():
    firmware = Firmware()
    firmware.receive(drive(500))
    firmware.step(3.0)
    before = firmware.drive.pose.x
    firmware.receive(drive(0))
    firmware.step(3.0)
    assert firmware.drive.pose.x - before == pytest.approx(0.5 * 0.2 + 0.5**2 / 2, abs=1e-4)


def test_an_overcurrent_cuts_the_motors_at_once_until_it_is_over():
    firmware = Firmware()
    firmware.receive(drive(300))
    firmware.step(2.0)
    firmware.sensors.flag("overcurrent", "left", on=True)
    told = packets(firmware.step(0.5))[-1]["core"]
    assert firmware.drive.speeds == REST
    assert (told["overcurrent"], told["left_pwm"]) == (1, 0)
    firmware.sensors.flag("overcurrent", "left", on=False)
    firmware.step(1.0)
    assert firmware.drive.speeds.left == pytest.approx(0.3)


@pytest.mark.parametrize("sensor", ["bumper", "cliff", "wheel_drop"])
def test_no_reflex_of_its_own_saves_the_base(sensor):
    firmware = Firmware()
    firmware.receive(drive(300))
    firmware.step(2.0)
    firmware.sensors.flag(sensor, "left", on=True)
    firmware.step(2.0)
    assert firmware.drive.speeds.left == pytest.approx(0.3)


def test_what_was_asked_for_is_told_once_in_the_next_packet():
    firmware = Firmware(identity=Identity(udid=(0x05D2FF30, 0x3236584D, 0x51256122)))
    assert answers(firmware) == {}
    firmware.receive(VERSIONS + VERSIONS + GET_GAINS)
    assert answers(firmware) == {
        "hardware": "04000100",
        "firmware": "00020100",
        "udid": "30ffd2054d58363222612551",
        "controller": "00a086010064000000d0070000",
    }
    assert answers(firmware) == {}
    firmware.receive(command(9, "<H", 2))
    assert answers(firmware) == {"firmware": "00020100"}


def test_the_answers_stand_behind_what_every_packet_tells():
    firmware = Firmware()
    firmware.receive(GET_GAINS + VERSIONS)
    payload = payloads(firmware.step(0.02))[0]
    assert payload[77:].hex().startswith("0a04040001000b0400020100130c")
    assert payload[103:].hex() == "150d00a086010064000000d0070000"


@pytest.mark.parametrize(
    ("version", "hardware", "firmware"),
    [
        ("1.0.0", "6800", "7b00"),  # 104 and 123: the old codes
        ("1.1.0", "6800", "6e00"),
        ("1.1.1", "6800", "6f00"),
        ("1.1.2", "04000100", "02010100"),
        ("1.1.4", "04000100", "04010100"),
        ("2.0.0", "04000100", "00000200"),
    ],
)
def test_each_version_names_itself_in_its_own_way(version, hardware, firmware):
    base = of_version(version)
    base.receive(command(9, "<H", 3))
    assert answers(base) == {"hardware": hardware, "firmware": firmware}


def test_gains_are_kept_and_given_back_to_the_factory():
    firmware = Firmware()
    firmware.receive(command(13, "<BIII", 1, 90_000, 50, 1_500) + GET_GAINS)
    assert answers(firmware) == {"controller": "01905f010032000000dc050000"}
    firmware.receive(command(13, "<BIII", 0, 1, 2, 3))
    assert firmware.gains == FACTORY_GAINS


def test_before_1_2_0_there_are_no_gains():
    firmware = of_version("1.1.4")
    firmware.receive(command(13, "<BIII", 1, 1, 2, 3) + GET_GAINS)
    assert answers(firmware) == {}
    assert firmware.gains == FACTORY_GAINS


def test_before_1_0_0_a_payload_has_no_lengths_no_gyro_and_no_answers():
    firmware = of_version("0.9.0")
    firmware.sensors.charger, firmware.sensors.battery = 22, 16.5
    firmware.sensors.flag("overcurrent", "right", on=True)
    firmware.receive(VERSIONS + GET_GAINS)
    payload = payloads(firmware.step(0.02))[0]
    assert len(payload) == 54
    assert (
        payload.hex()
        == (
            "01" + "14000000000000000000000016a5"  # no overcurrent flag either
            "03000000"
            "0400000000000000"
            "05020802080208"
            "060101"
            "1000000000000000000000000000000000"
        )
    )


def test_the_outputs_start_with_all_supplies_on_and_are_one_word():
    firmware = Firmware()
    assert firmware.output == 0x00F0
    firmware.receive(command(12, "<H", 0x0200))
    assert firmware.output == 0x0200


def test_the_last_of_each_command_is_kept():
    firmware = Firmware()
    firmware.step(1.5)
    firmware.receive(command(3, "<HB", 826, 100) + command(4, "<B", 3) + command(4, "<B", 4))
    heard = firmware.received
    assert vars(heard.last["sound"]) == {"note": 826, "duration": 100}
    assert vars(heard.last["sound_sequence"]) == {"number": 4}
    assert heard.count["sound_sequence"] == 2
    assert heard.time["sound"] == 1.5


def test_a_power_cycle_starts_all_over_where_the_base_stands():
    firmware = Firmware()
    firmware.receive(drive(300, 1000) + command(12, "<H", 0) + command(13, "<BIII", 1, 1, 2, 3))
    firmware.step(5.0)
    firmware.power_cycle(1.0)
    assert not firmware.powered
    assert firmware.receive(drive(300)) == []
    assert firmware.step(0.999) == b""
    rest = firmware.drive.pose
    assert rest.x > 0.5
    told = packets(firmware.step(0.5))
    assert [packet["core"]["stamp"] for packet in told[:2]] == [20, 40]
    assert told[-1]["core"]["left"] == told[-1]["inertia"][0] == 0
    assert (firmware.output, firmware.gains, firmware.drive.pose) == (0x00F0, FACTORY_GAINS, rest)
    assert firmware.time == pytest.approx(6.499)


def test_half_a_command_does_not_outlive_the_power():
    firmware = Firmware()
    firmware.receive(drive(300)[:5])
    firmware.power_cycle(0.0)
    assert firmware.receive(drive(300)[5:]) == []


def test_a_base_may_be_flashed():
    firmware = Firmware()
    firmware.step(1.0)
    firmware.flash(Version(1, 1, 4))
    firmware.receive(VERSIONS)
    told = packets(firmware.step(0.02))[0]
    assert told["core"]["stamp"] == 20
    assert told["firmware"] == struct.pack("4B", 4, 1, 1, 0)


@pytest.mark.parametrize("text", ["1.2", "1.2.x", "1.2.256", "", "-1.0.0"])
def test_what_is_no_version_is_refused(text):
    with pytest.raises(ValueError, match="is no version"):
        Version.parse(text)
