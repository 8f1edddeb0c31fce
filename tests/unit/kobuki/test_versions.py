"""A base that this software does not know is refused, and its owner told what to do."""

import pytest

from services.kobuki.versions import UNTOLD, Version, advice, has_gains, refusal

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
    why = refusal(UNTOLD, None)
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
