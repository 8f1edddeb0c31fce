"""One line, one fault."""

import json

import pytest

from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.control import COMMANDS, ControlError, execute
from cliffscan.simulator.kobuki.firmware import Firmware
from cliffscan.simulator.kobuki.sensors import DROP_ADC, FLOOR_ADC
from tests.unit.kobuki_emulator.packets import command, drive, packets


def told(base):
    return packets(b"".join(base.step(0.02)))[0]


def sensors(base):
    return base.firmware.sensors


@pytest.mark.parametrize(
    ("line", "field", "value"),
    [
        ("bumper left on", "bumper", 4),
        ("bumper centre on", "bumper", 2),
        ("cliff right on", "cliff", 1),
        ("wheel_drop right on", "wheel_drop", 1),
        ("wheel_drop left on", "wheel_drop", 2),
        ("overcurrent left on", "overcurrent", 1),
        ("overcurrent right on", "overcurrent", 2),
        ("button 0 press", "button", 1),
        ("button 2 press", "button", 4),
        ("battery 13.0", "battery", 130),
        ("battery 99", "battery", 255),
        ("charger adapter_charging", "charger", 22),
        ("charger dock_charged", "charger", 2),
    ],
)
def test_a_line_shows_in_the_core(line, field, value):
    base = Base()
    assert execute(base, line) == "ok"
    assert told(base)["core"][field] == value


@pytest.mark.parametrize("line", ["bumper left", "cliff left", "wheel_drop left", "overcurrent left"])
def test_what_is_on_can_be_off_again(line):
    base = Base()
    execute(base, f"{line} on")
    execute(base, f"{line} off")
    assert base.firmware.sensors == Base().firmware.sensors


def test_a_button_is_released():
    base = Base()
    execute(base, "button 1 press")
    execute(base, "button 1 release")
    assert told(base)["core"]["button"] == 0


def test_a_cliff_has_its_raw_reading_fall():
    base = Base()
    execute(base, "cliff left on")
    assert told(base)["cliff"] == [FLOOR_ADC, FLOOR_ADC, DROP_ADC]
    execute(base, "cliff left off")
    execute(base, "cliff_adc centre 1234")
    assert told(base)["cliff"] == [FLOOR_ADC, 1234, FLOOR_ADC]


def test_the_other_sensors():
    base = Base()
    for line in ("dock_ir centre 9", "current right 1.5", "digital_input 10", "analog_input 3 4095"):
        execute(base, line)
    packet = told(base)
    assert packet["dock_ir"] == [0, 9, 0]
    assert packet["current"] == [1, 150]
    assert packet["inputs"] == (10, 0, 0, 0, 4095)


def test_time_faults():
    base = Base()
    execute(base, "skip 40")
    assert told(base)["core"]["stamp"] == 40020
    execute(base, "power_cycle 0.5")
    assert base.step(0.5) == []
    assert told(base)["core"]["stamp"] == 20
    execute(base, "power_cycle")
    assert not base.firmware.powered
    assert base.step(1.0) == []
    execute(base, "firmware 0.9.0")
    assert len(base.step(0.02)[0]) == 58


def test_line_faults():
    base = Base()
    execute(base, "pause 0.1")
    assert base.step(0.1) == []
    execute(base, "garbage 100")
    assert len(base.step(0.02)[0]) == 181
    execute(base, "cut 7")
    assert {len(piece) for piece in base.step(0.1)} == {7}
    execute(base, "cut 0")
    base.step(0.02)
    execute(base, "corrupt 1")
    broken = base.step(0.02)[0]
    with pytest.raises(AssertionError):
        packets(broken)
    execute(base, "unplug 2.0")
    assert not base.plugged


def test_wheels_may_be_made_to_slip():
    base = Base()
    execute(base, "slip 0.1 0.2 0.03")
    model = base.firmware.drive.model
    assert (model.slip, model.noise) == ((0.1, 0.2), 0.03)
    execute(base, "slip 0 0")
    assert base.firmware.drive.model.noise == 0.03
    with pytest.raises(ControlError, match="slip of 3"):
        execute(base, "slip 3 0")


def test_wheels_of_another_make_are_left_alone():
    class Others:
        travelled = speeds = (0.0, 0.0)

    base = Base()
    base.firmware.drive = Others()
    with pytest.raises(ControlError, match="as their own world has them"):
        execute(base, "slip 0 0")


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("", "no command is named ''; `help` tells"),
        ("bumpers left on", "no command is named 'bumpers'"),
        ("bumper", "expected bumper left|centre|right on|off"),
        ("bumper middle on", "expected bumper left|centre|right on|off"),
        ("bumper left on please", "expected bumper left|centre|right on|off"),
        ("button 0 on", "expected button 0|1|2 press|release"),
        ("battery full", "expected battery VOLTS"),
        ("battery nan", "expected battery VOLTS"),
        ("unplug", "expected unplug SECONDS"),
        ("unplug -1", "unplug: -1.0 s, expected a span"),
        ("power_cycle 1 2", "expected power_cycle [SECONDS]"),
        ("garbage 1.5", "garbage: 1.5, expected a whole number of 0 or more"),
        ("cut -7", "cut: -7, expected a whole number"),
        ("firmware one", "firmware: 'one' is no version"),
    ],
)
def test_a_bad_line_is_refused_and_changes_nothing(line, reason):
    base = Base()
    with pytest.raises(ControlError) as refused:
        execute(base, line)
    assert reason in str(refused.value)
    assert sensors(base) == sensors(Base())


def test_the_state_is_json_and_tells_all():
    base = Base(Firmware(dead_time=0.0))
    base.receive(drive(200) + command(12, "<H", 0x0395) + command(3, "<HB", 826, 100) + b"\0" + command(99, "<B", 7))
    base.step(2.0)
    state = json.loads(execute(base, "state"))
    assert state["received"]["base_control"] == {
        "time": 0.0,
        "count": 1,
        "command": "base_control",
        "speed": 200,
        "radius": 0,
    }
    assert state["received"]["unknown"]["data"] == "07"
    assert state["output"] == {
        "word": 0x0395,
        "digital": 5,
        "supplies": {"3.3V": True, "5V": False, "12V5A": False, "12V1.5A": True},
        "leds": ["orange", "off"],
    }
    assert state["truth"]["x"] == pytest.approx(0.38)
    assert state["target"] == {"left": 0.2, "right": 0.2}
    assert (state["packets"], state["discarded"], state["time"], state["firmware"]) == (100, 1, 2.0, "1.2.0")
    assert (state["powered"], state["plugged"], state["connected"], state["motors_cut"]) == (True, True, False, False)


def test_help_lists_every_command():
    told = execute(Base(), "help").split("; ")
    assert told[:3] == ["state", "watch", "bumper left|centre|right on|off"]
    assert len(told) == len(COMMANDS) + 2


def test_every_command_has_a_usage_that_some_words_fit():
    examples = {"VERSION": "1.2.0"}
    for name, (usage, _) in COMMANDS.items():
        words = [
            examples.get(part, "0") if part.strip("[]").isupper() else part.split("|")[0] for part in usage.split()
        ]
        assert execute(Base(), " ".join([name, *words])) == "ok"
