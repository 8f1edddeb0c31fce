"""Frames go as a link carries them: none waits where answers come soon, and the newest goes where they do not."""

import pytest

from cliffscan.services.capture.window import SILENCE, Size, Window

PERIOD = 1 / 30  # [s]
BYTES = {Size.FULL: 85_000, Size.HALF: 16_000, Size.THIRD: 12_000}
WORK = 0.015  # [s] that perception takes


class Drive:
    """A camera, a window, a link and a perception; each frame takes the link for its own time, one after another."""

    def __init__(self, rate, delay=0.005, period=PERIOD):
        self.rate, self.delay, self.period = rate, delay, period  # [bit/s], [s]; a rate of 0 loses all
        self.window = Window(period)
        self.sent, self.ages = [], []  # (time, size), (time, age) of answered frames
        self._answers, self._busy, self._seq, self.now = [], 0.0, 0, 0.0

    def run(self, seconds):
        end = self.now + seconds
        while self.now < end:
            for at, seq, taken in [each for each in self._answers if each[0] <= self.now]:
                self.window.answer(seq, at)
                self.ages.append((at, at - taken))
            self._answers = [each for each in self._answers if each[0] > self.now]
            size = self.window.admit(self._seq, self.now)
            if size:
                self._send(size)
            self._seq += 1
            self.now += self.period
        return self

    def _send(self, size):
        self.sent.append((self.now, size))
        if self.rate:
            self._busy = max(self._busy, self.now) + 8 * BYTES[size] / self.rate
            self._answers.append((self._busy + 2 * self.delay + WORK, self._seq, self.now))

    def share(self, size, since=0.0):
        sizes = [each for at, each in self.sent if at >= since]
        return sizes.count(size) / len(sizes)

    def frequency(self, since):
        return sum(at >= since for at, _ in self.ages) / (self.now - since)

    def oldest(self, since):
        return max(age for at, age in self.ages if at >= since)


def test_a_good_link_carries_every_frame_whole():
    drive = Drive(200e6).run(20.0)
    assert len(drive.sent) == pytest.approx(600, abs=1)
    assert drive.share(Size.FULL) == 1.0


def test_where_nobody_answers_every_frame_goes_whole():
    drive = Drive(0).run(10.0)
    assert len(drive.sent) == pytest.approx(300, abs=1)
    assert drive.share(Size.FULL) == 1.0


def test_a_fast_camera_keeps_more_frames_on_the_way():
    drive = Drive(1e9, delay=0.02, period=0.01).run(5.0)
    assert len(drive.sent) == pytest.approx(500, abs=1)


@pytest.mark.parametrize(
    ("rate", "delay", "least", "oldest"),
    [(20e6, 0.005, 28.0, 0.12), (6e6, 0.02, 28.0, 0.13), (2e6, 0.05, 14.0, 0.27)],
)
def test_a_thin_link_carries_the_newest_frames_soon(rate, delay, least, oldest):
    drive = Drive(rate, delay).run(90.0)
    ages = sorted(age for at, age in drive.ages if at > 30.0)
    assert drive.frequency(30.0) >= least
    assert ages[int(0.99 * len(ages))] < oldest
    assert drive.share(Size.HALF if rate == 20e6 else Size.THIRD, 30.0) > 0.9


def test_tries_grow_rare_where_they_fail():
    drive = Drive(6e6).run(300.0)
    tries = [at for at, size in drive.sent if size is Size.FULL and at > 5.0]
    assert 3 <= len(tries) <= 10
    assert tries[-1] - tries[-2] > 30.0


def test_frames_are_whole_again_when_the_link_is():
    drive = Drive(6e6).run(10.0)
    drive.rate = 200e6
    drive.run(150.0)
    assert drive.share(Size.FULL, drive.now - 5.0) == 1.0
    assert drive.window.size is Size.FULL


def test_in_an_outage_few_frames_go_and_then_none_waits():
    drive = Drive(20e6).run(30.0)
    drive.rate = 0
    began, before = drive.now, len(drive.sent)
    drive.run(SILENCE - 0.1)
    assert len(drive.sent) - before < 18
    drive.rate = 20e6
    drive.run(10.0)
    assert min(at for at, _ in drive.ages if at > began + SILENCE - 0.1) < began + SILENCE + 0.5
    assert drive.oldest(began + SILENCE) < 0.2


def test_when_answers_end_for_good_every_frame_goes_again():
    drive = Drive(20e6).run(30.0)
    drive.rate = 0
    drive.run(SILENCE + 0.5)
    ended, before = drive.now, len(drive.sent)
    drive.run(2.0)
    assert len(drive.sent) - before == pytest.approx(60, abs=2)
    assert drive.share(Size.FULL, ended) == 1.0


def test_an_answer_to_an_unknown_frame_is_no_news_of_the_link():
    window = Window(PERIOD)
    window.answer(99, 0.0)
    assert [window.admit(seq, 0.01) for seq in range(5)] == [Size.FULL] * 3 + [None] * 2
    window.answer(1, 0.02)
    assert [window.admit(seq, 0.03) for seq in range(5, 9)] == [Size.FULL] * 2 + [None] * 2


def test_a_try_that_was_overtaken_is_repeated():
    window = Window(PERIOD)
    window.answer(0, 0.0)
    now, seq = 0.0, 1
    while window.size is Size.FULL:
        window.admit(seq, now)
        window.answer(seq, now + 0.2)
        now, seq = now + 0.2, seq + 1

    def tried():
        nonlocal now, seq
        while (size := window.admit(seq, now)) is Size.HALF:
            window.answer(seq, now + 0.02)
            now, seq = now + PERIOD, seq + 1
        return size

    for _ in range(2):
        assert tried() is Size.FULL
        assert window.admit(seq + 1, now) is Size.HALF
        window.answer(seq + 1, now + 0.02)
        seq += 2


def silent(window, seq, since):
    """[s] until the next frame goes, while nobody answers those that went."""
    now = since
    while not window.admit(seq, now):
        seq, now = seq + 1, now + 0.001
    return now - since


@pytest.mark.parametrize(("delay", "waits"), [(0.03, 0.2), (0.13, 0.26)])
def test_what_is_late_for_this_link_keeps_no_frame_waiting(delay, waits):
    window = Window(1.0)
    for seq in range(30):
        window.answer(seq, seq + delay if window.admit(seq, float(seq)) else 0.0)
    while window.admit(seq := seq + 1, 30.0):
        pass
    assert silent(window, seq, 30.0) == pytest.approx(waits, abs=0.002)


def test_a_try_that_an_outage_swallowed_is_repeated():
    drive = Drive(6e6).run(10.0)
    while drive.sent[-1][1] is drive.window.size:
        drive.run(PERIOD)
    drive.rate, drive._answers = 0, []
    drive.run(SILENCE + 1.0)
    drive.rate = 200e6
    drive.run(120.0)
    assert drive.window.size is Size.FULL
