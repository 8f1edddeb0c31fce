"""A base that this software does not know is refused, and its owner told what to do."""

import pytest

from cliffscan.services.kobuki.protocol.packets import decode
from cliffscan.services.kobuki.protocol.versions import UNREPORTED, Version, advice, has_gains, refusal

HARDWARE = Version(1, 0, 4)


@pytest.mark.parametrize("firmware", [(1, 0, 0), (1, 1, 4), (1, 2, 0), (1, 9, 0)])
def test_every_version_of_major_1_may_be_driven(firmware):
    assert refusal(Version(*firmware), HARDWARE) is None


@pytest.mark.parametrize("firmware", [(0, 1, 1), (0, 99, 99), (2, 0, 0), (3, 1, 4)])
def test_every_other_is_refused(firmware):
    why = refusal(Version(*firmware), HARDWARE)
    assert f"firmware {Version(*firmware)} (hardware 1.0.4)" in why
    assert "https://kobuki.readthedocs.io" in why
    assert (
        "put firmware 1.2.0 on the base" if firmware[0] == 0 else "upgrade the software, or the base to 1.2.0"
    ) in why
    assert "\n" not in why


def test_firmware_that_cannot_tell_its_version_is_refused():
    why = refusal(UNREPORTED, None)
    assert why.startswith("firmware that sends packets without sub-payload lengths is older than 1.0.0")
    assert "0.0.0" not in why


@pytest.mark.parametrize(
    ("firmware", "what"),
    [
        ((1, 1, 4), None),
        ((1, 2, 0), None),
        ((1, 0, 0), "replace the firmware"),
        ((1, 1, 3), "replace the firmware"),
        ((1, 1, 5), "replace the firmware"),
        ((1, 2, 1), "newer than 1.2.0: upgrade the software"),
        ((1, 3, 0), "newer than 1.2.0: upgrade the software"),
    ],
)
def test_advice(firmware, what):
    told = advice(Version(*firmware), None)
    assert told is None if what is None else what in told
    assert told is None or f"firmware {Version(*firmware)} is" in told


def test_gains_came_with_1_2():
    assert not has_gains(Version(1, 1, 9))
    assert has_gains(Version(1, 2, 0))


@pytest.mark.parametrize(
    ("ident", "data", "version"),
    [
        (10, "04000100", "1.0.4"),
        (11, "00020100", "1.2.0"),
        (10, "6800", "1.0.4"),
        (11, "7b00", "1.0.0"),
        (11, "6e00", "1.1.0"),
        (11, "7427", "1.1.0"),
        (11, "6f00", "1.1.1"),
        (11, "7527", "1.1.1"),
    ],
)
def test_a_version_is_read_from_four_bytes_or_an_old_code(ident, data, version):
    found = decode(bytes([ident, len(data) // 2]) + bytes.fromhex(data))
    assert str(found.hardware or found.firmware) == version
    assert (found.hardware is None) == (ident == 11)


def test_an_unheard_of_version_code_is_no_version():
    found = decode(bytes.fromhex("0b02c800"))
    assert found.firmware is None
    assert "version code 200, expected one of 110, 111, 123, 10100, 10101" in found.skipped[0].why
