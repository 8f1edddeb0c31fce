"""Everything is counted, and told at a limited rate."""

import logging
import threading

import pytest

from cliffscan.common.runtime import metrics as module
from cliffscan.common.runtime.metrics import Tally


class Clock:
    """Stands in for the module `time`."""

    now = 100.0

    def monotonic(self):
        return self.now

    def time_ns(self):
        return round(self.now * 1e9)


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    return clock


@pytest.fixture
def tally(clock):
    return Tally()


def test_counts_add_up(tally):
    tally.count("received")
    tally.count("received", by=3)
    tally.complain("malformed", "why")
    assert tally.counts() == {"received": 4, "malformed": 1}


def test_counts_are_a_copy(tally):
    tally.counts()["received"] = 7
    assert tally.counts() == {}


def test_a_complaint_is_told_with_its_reason_and_count(tally, caplog):
    tally.complain("malformed", "camera/depth: floor: missing")
    assert caplog.messages == ["malformed (1 so far): camera/depth: floor: missing"]
    assert caplog.records[0].levelno == logging.WARNING


def test_complaints_of_one_kind_are_told_once_a_second_and_all_counted(tally, clock, caplog):
    for tenth in range(25):
        clock.now = 100 + tenth / 10
        tally.complain("malformed", f"at {tenth}")
    assert [message.rpartition(" ")[2] for message in caplog.messages] == ["0", "10", "20"]
    assert "(21 so far)" in caplog.messages[-1]
    assert tally.counts() == {"malformed": 25}


def test_complaints_of_another_kind_are_told_at_once(tally, caplog):
    tally.complain("malformed", "one")
    tally.complain("mismatch", "other")
    assert len(caplog.messages) == 2


def test_the_first_complaint_after_the_start_of_the_machine_is_told(tally, clock, caplog):
    clock.now = 0.0
    tally.complain("malformed", "early")
    assert len(caplog.messages) == 1


def test_latencies_run_from_capture_to_output(tally, clock):
    assert tally.latency() == (0.0, 0.0)
    for milliseconds in range(101):
        tally.output(round((clock.now - milliseconds / 1000) * 1e9))
    median, worst = tally.latency()
    assert median == pytest.approx(0.050)
    assert worst == pytest.approx(0.099)


def test_old_latencies_are_forgotten(tally, clock):
    for _ in range(module.WINDOW):
        tally.output(0)
    for _ in range(module.WINDOW):
        tally.output(round(clock.now * 1e9))
    assert tally.latency() == pytest.approx((0.0, 0.0))


def test_outputs_are_taken_once(tally):
    for _ in range(3):
        tally.output(0)
    assert (tally.take_outputs(), tally.take_outputs()) == (3, 0)


def test_no_count_is_lost_between_threads(tally):
    def work():
        for _ in range(2000):
            tally.count("received")
            tally.complain("malformed", "why")

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert tally.counts() == {"received": 8000, "malformed": 8000}
