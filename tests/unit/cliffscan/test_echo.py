"""`cliffscan echo` ends in time, whether messages come or not."""

import itertools

import pytest

from cliffscan import echo as module
from cliffscan.echo import echo
from tests.build import Bus, Stop


class Queue:
    """Has a message whenever it is asked, or never."""

    def __init__(self, busy):
        self._busy = busy

    def get(self, _timeout):
        return ("map/mine", b"") if self._busy else None


@pytest.fixture
def echoed(monkeypatch):
    """Echo on a clock that goes on by a second whenever it is read; the exit code."""

    def run(count, timeout, busy):
        times = itertools.count(100.0)
        monkeypatch.setattr(module.time, "monotonic", lambda: next(times))
        monkeypatch.setattr(module, "LatestQueue", lambda _room: Queue(busy))
        monkeypatch.setattr(module, "live_keys", lambda *_: [])
        return echo(Bus(), "map/mine", count, timeout, False, Stop())

    return run


@pytest.mark.parametrize("busy", [True, False])
@pytest.mark.parametrize("count", [0, 100])
def test_the_time_is_over_whether_messages_come_or_not(echoed, capsys, count, busy):
    assert echoed(count, 3.5, busy) == 1
    came, said = capsys.readouterr()
    assert came.count("\n") == (4 if busy else 0)
    what = f"4 of {count or 'all'} messages" if busy else "nothing"
    assert f"cliffscan: {what} on turtlebot/map/mine within 3.5 s" in said


def test_the_last_message_may_come_late(echoed, capsys):
    assert echoed(4, 3.5, True) == 0
    assert capsys.readouterr().err == ""
