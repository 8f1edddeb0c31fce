"""Everything is counted, and told at a limited rate."""

import logging
import threading

import pytest

from cliffscan.common.runtime import metrics as module
from cliffscan.common.runtime.metrics import ServiceMetrics


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
def metrics(clock):
    return ServiceMetrics()


def test_counts_add_up(metrics):
    metrics.count("received")
    metrics.count("received", by=3)
    metrics.warn_limited("malformed", "why")
    assert metrics.counts() == {"received": 4, "malformed": 1}


def test_counts_are_a_copy(metrics):
    metrics.counts()["received"] = 7
    assert metrics.counts() == {}


def test_a_complaint_is_told_with_its_reason_and_count(metrics, caplog):
    metrics.warn_limited("malformed", "camera/depth: floor: missing")
    assert caplog.messages == ["malformed (1 so far): camera/depth: floor: missing"]
    assert caplog.records[0].levelno == logging.WARNING


def test_complaints_of_one_kind_are_told_once_a_second_and_all_counted(metrics, clock, caplog):
    for tenth in range(25):
        clock.now = 100 + tenth / 10
        metrics.warn_limited("malformed", f"at {tenth}")
    assert [message.rpartition(" ")[2] for message in caplog.messages] == ["0", "10", "20"]
    assert "(21 so far)" in caplog.messages[-1]
    assert metrics.counts() == {"malformed": 25}


def test_complaints_of_another_kind_are_told_at_once(metrics, caplog):
    metrics.warn_limited("malformed", "one")
    metrics.warn_limited("mismatch", "other")
    assert len(caplog.messages) == 2


def test_the_first_complaint_after_the_start_of_the_machine_is_told(metrics, clock, caplog):
    clock.now = 0.0
    metrics.warn_limited("malformed", "early")
    assert len(caplog.messages) == 1


def test_latencies_run_from_capture_to_output(metrics, clock):
    assert metrics.latency() == (0.0, 0.0)
    for milliseconds in range(101):
        metrics.output(round((clock.now - milliseconds / 1000) * 1e9))
    median, worst = metrics.latency()
    assert median == pytest.approx(0.050)
    assert worst == pytest.approx(0.099)


def test_old_latencies_are_forgotten(metrics, clock):
    for _ in range(module.WINDOW):
        metrics.output(0)
    for _ in range(module.WINDOW):
        metrics.output(round(clock.now * 1e9))
    assert metrics.latency() == pytest.approx((0.0, 0.0))


def test_outputs_are_taken_once(metrics):
    for _ in range(3):
        metrics.output(0)
    assert (metrics.take_outputs(), metrics.take_outputs()) == (3, 0)


def test_no_count_is_lost_between_threads(metrics):
    def work():
        for _ in range(2000):
            metrics.count("received")
            metrics.warn_limited("malformed", "why")

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert metrics.counts() == {"received": 8000, "malformed": 8000}
