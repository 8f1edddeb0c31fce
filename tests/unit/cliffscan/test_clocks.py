"""Clocks that differ are told from those that agree, whatever the network takes."""

import pytest

from cliffscan.clocks import KEPT, Clocks

MS = 10**6
DAY = 86_400 * 10**9


def clocks(**offsets):
    """Each service's clock is `offset` [ns] ahead of the local one; some statuses take longer than others."""
    made = Clocks()
    for service, offset in offsets.items():
        for way in (70 * MS, 3 * MS, 20 * MS):
            made.receive(service, DAY + offset, DAY + way)
    return made


def test_clocks_that_agree_are_not_corrected():
    made = clocks(capture=5000 * MS, fuse=5030 * MS)
    assert made.ahead("fuse") == 0.0


@pytest.mark.parametrize("offset", [-10_000, -60, 60, 10_000])
@pytest.mark.parametrize("robot", [0, -3000])
def test_a_clock_that_differs_from_the_robots_is_found(offset, robot):
    made = clocks(capture=robot * MS, kobuki=robot * MS, fuse=(robot + offset) * MS)
    assert made.ahead("fuse") == pytest.approx(offset / 1e3)
    assert made.ahead("kobuki") == 0.0


def test_without_capture_the_base_is_the_reference_and_without_both_none_is():
    assert clocks(kobuki=0, fuse=100 * MS).reference() == "kobuki"
    assert clocks(fuse=0, negative=500 * MS).ahead("negative") == 0.0
    assert Clocks().reference() == ""


def test_a_clock_that_was_set_is_followed():
    made = clocks(capture=0, fuse=10_000 * MS)
    for _ in range(KEPT):
        made.receive("fuse", DAY, DAY + MS)
    assert made.ahead("fuse") == 0.0
