"""Every command is understood, and what is none is left behind by its length."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator.kobuki.commands import (
    BaseControl,
    GetGains,
    Output,
    Request,
    SetGains,
    Sound,
    SoundSequence,
    Unknown,
    decode,
)


@pytest.mark.parametrize(
    ("payload", "expected"),
    [
        ("010400000000", BaseControl(0, 0)),
        ("0104fffe70fe", BaseControl(-257, -400)),
        ("010401019001", BaseControl(257, 400)),
        ("03033a0364", Sound(826, 100)),
        ("040104", SoundSequence(4)),
        ("09020b00", Request(11)),
        ("0c02f002", Output(0x02F0)),
        ("0d0d01a086010064000000d0070000", SetGains(1, 100_000, 100, 2_000)),
        ("0e0100", GetGains(0)),
        ("0203010203", Unknown(2, b"\1\2\3")),  # an identifier that means nothing
        ("01020000", Unknown(1, b"\0\0")),  # base control of two bytes
        ("0104000000", Unknown(1, b"\0\0\0")),  # cut off by the end of its payload
        ("01", Unknown(1, b"")),
    ],
)
def test_a_command_is_decoded(payload, expected):
    assert decode(bytes.fromhex(payload)) == [expected]


def test_several_commands_share_a_frame_and_a_bad_one_hides_none():
    payload = bytes.fromhex("0c02f0000301ff6302010201046400000004")
    assert decode(payload) == [
        Output(0x00F0),
        Unknown(3, b"\xff"),
        Unknown(99, b"\1\2"),
        BaseControl(100, 0),
        Unknown(4, b""),
    ]


@given(st.binary(max_size=64))
def test_nothing_is_too_strange(payload):
    assert bool(decode(payload)) == bool(payload)


def test_a_note_is_a_frequency():
    assert Sound(826, 100).frequency == pytest.approx(440.2, abs=0.1)
    assert Sound(0, 100).frequency == 0.0
