"""Every command as bytes, and what the base cannot do is refused with what it can."""

import math
import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from cliffscan.services.kobuki.kinematics import speed_and_radius
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.commands import LedColour, Outputs, SoundSequence, Supply
from cliffscan.services.kobuki.protocol.sensors import Gains, GainSet
from tests.kobuki_stream import framed

velocities = st.one_of(st.floats(-2, 2), st.floats(-5e-3, 5e-3), st.floats(allow_nan=False, allow_infinity=False))


@pytest.mark.parametrize(
    ("linear", "angular", "wire"),
    [
        (0, 0, "aa550601040000000003"),
        (0.1, 0, "aa550601046400000067"),
        (0, 1.0, "aa550601047300010071"),
        (0, -1.0, "aa550601048dff010070"),
        (0.2, 0.5, "aa550601040101900192"),
        (-0.2, 0.5, "aa55060104fffe70fe8c"),
    ],
)
def test_base_control(linear, angular, wire):
    assert commands.base_control(linear, angular).hex() == wire


@pytest.mark.parametrize(
    ("linear", "angular", "expected"),
    [
        (0.1159, 0, (115, 0)),
        (0.1, 0.00009, (100, 0)),
        (0.1, 0.0001, (100, 32767)),
        (0.00009, 1, (115, 1)),
        (0.00009, 0.01, (1, 1)),
        (0.0001, 0.01, (1, 10)),
        (0.001, 1, (115, 1)),
        (0.0011, 1, (116, 1)),
        (-0.001, 1, (115, 1)),
        (-0.0015, 1, (115, 1)),
        (0.0015, -1, (-115, 1)),
        (-0.0021, 1, (-117, -2)),
        (-0.2, -0.5, (-257, 400)),
        (0.1, -3.0, (445, -33)),
        (40, 0, (32767, 0)),
        (-40, 0, (-32768, 0)),
        (0, 400, (32767, 1)),
        (-0.5, 0.001, (-500, -32768)),
    ],
)
def test_speed_and_radius(linear, angular, expected):
    assert speed_and_radius(linear, angular) == expected


@given(velocities, velocities)
@example(-0.0015, 1.0)
def test_the_radius_is_never_the_undefined_one(linear, angular):
    speed, radius = speed_and_radius(linear, angular)
    assert radius != -1
    struct.pack("<2h", speed, radius)


@given(st.floats(-0.7, 0.7), st.floats(-1.9, 1.9))
def test_the_wheels_do_what_was_asked(linear, angular):
    """What the base makes of speed and radius, up to whole millimetres: the outer wheel has the speed."""
    speed, radius = speed_and_radius(linear, angular)
    if radius == 0:
        found = speed, 0.0
    elif radius == 1:
        found = 0.0, speed / 115
    else:
        found = speed * radius / (radius + math.copysign(115, radius)), speed / (radius + math.copysign(115, radius))
    assert found[0] == pytest.approx(1000 * linear, abs=4)
    assert found[1] == pytest.approx(angular, abs=0.025)


@pytest.mark.parametrize(("linear", "angular"), [(math.nan, 0), (0, math.nan), (math.inf, 0), (0.1, -math.inf)])
def test_a_velocity_that_is_no_number_is_refused(linear, angular):
    with pytest.raises(ValueError, match="expected finite numbers"):
        commands.base_control(linear, angular)


def test_the_supplies_are_on_from_the_start():
    assert Outputs().encode().hex() == "aa55040c02f000fa"
    assert Outputs().with_led(1, LedColour.GREEN).encode().hex() == "aa55040c02f002f8"


def test_the_outputs_share_one_word():
    outputs = Outputs()
    words = []
    for change in (
        lambda state: state.with_led(1, LedColour.ORANGE),
        lambda state: state.with_led(2, LedColour.RED),
        lambda state: state.with_led(1, LedColour.GREEN),
        lambda state: state.with_digital_output(0, True),
        lambda state: state.with_digital_output(3, True),
        lambda state: state.with_supply(Supply.V12_5A, False),
        lambda state: state.with_digital_output(0, False),
        lambda state: state.with_supply(Supply.V12_5A, True),
        lambda state: state.with_led(2, LedColour.OFF),
    ):
        outputs = change(outputs)
        words.append(outputs.word)
    assert words == [0x3F0, 0x7F0, 0x6F0, 0x6F1, 0x6F9, 0x6B9, 0x6B8, 0x6F8, 0x2F8]


@pytest.mark.parametrize(("supply", "word"), [("V3_3", 0xE0), ("V5", 0xD0), ("V12_5A", 0xB0), ("V12_1A5", 0x70)])
def test_each_supply_has_its_bit(supply, word):
    assert Outputs().with_supply(Supply[supply], False).word == word


def test_outputs_that_are_switched_twice_are_switched_once():
    outputs = Outputs().with_digital_output(2, True)
    assert outputs.with_digital_output(2, True) == outputs
    assert outputs.with_led(1, LedColour.OFF) == outputs
    assert outputs.with_supply(Supply.V5, True) == outputs


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda: Outputs().with_led(0, LedColour.RED), "LED 0, expected 1 or 2"),
        (lambda: Outputs().with_led(1, 4), "LedColour 4, expected one of 0 (off), 1 (red), 2 (green), 3 (orange)"),
        (lambda: Outputs().with_digital_output(4, True), "digital output 4, expected 0 to 3"),
        (lambda: Outputs().with_supply(0x11, True), "Supply 17, expected one of 16 (v3_3), 32 (v5)"),
        (lambda: commands.sound_sequence(7), "SoundSequence 7, expected one of 0 (on), 1 (off)"),
        (lambda: commands.set_gains(Gains(2, 1, 1, 1)), "GainSet 2, expected one of 0 (factory), 1 (user)"),
        (lambda: commands.set_gains(Gains(GainSet.USER, 1, -0.1, 1)), "gain i of -0.1, expected 0 to 4294967.295"),
        (lambda: commands.set_gains(Gains(GainSet.USER, math.nan, 1, 1)), "gain p of nan"),
        (lambda: commands.set_gains(Gains(GainSet.USER, 1, 1, 4294967.3)), "gain d of 4294967.3"),
        (lambda: commands.sound(5.5, 0.1), "frequency of 5.5 Hz, expected 5.55 to 363636 Hz"),
        (lambda: commands.sound(math.inf, 0.1), "frequency of inf Hz"),
        (lambda: commands.sound(math.nan, 0.1), "frequency of nan Hz"),
        (lambda: commands.sound(440, 0.256), "duration of 0.256 s, expected 0.001 to 0.255 s"),
        (lambda: commands.sound(440, 0), "duration of 0 s"),
    ],
)
def test_what_cannot_be_is_refused(change, expected):
    with pytest.raises(ValueError) as error:  # noqa: PT011  (the text is compared below)
        change()
    assert str(error.value).startswith(expected)


@pytest.mark.parametrize(
    ("name", "code"),
    [("ON", 0), ("OFF", 1), ("RECHARGE", 2), ("BUTTON", 3), ("ERROR", 4), ("CLEANING_START", 5), ("CLEANING_END", 6)],
)
def test_sound_sequences(name, code):
    assert commands.sound_sequence(SoundSequence[name]) == framed([4, 1, code])


@pytest.mark.parametrize(
    ("frequency", "duration", "note", "milliseconds"),
    [
        (440.0, 0.1, 826, 100),
        (1000.0, 0.255, 364, 255),
        (1 / (65535 * 0.00000275), 0.001, 65535, 1),
        (1 / 0.00000275, 0.2, 1, 200),
    ],
)
def test_a_note(frequency, duration, note, milliseconds):
    assert commands.sound(frequency, duration) == framed([3, 3, note & 0xFF, note >> 8, milliseconds])


@given(st.floats(5.55, 363636), st.floats(0.001, 0.255))
def test_every_note_in_range_fits(frequency, duration):
    assert len(commands.sound(frequency, duration)) == 9


def test_requests():
    assert commands.request_versions().hex() == "aa550409020b0004"
    assert commands.get_gains().hex() == "aa55030e01000c"


def test_gains():
    assert commands.set_gains(Gains(GainSet.USER, 100.0, 0.1, 2.0)).hex() == "aa550f0d0d01a086010064000000d00700009a"
    assert commands.set_gains(Gains(GainSet.USER, 4294967.295, 0, 0))[6:10] == b"\xff\xff\xff\xff"
