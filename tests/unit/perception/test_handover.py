"""The workstation's scans are published while they come in time, and the robot's as soon as they do not."""

import itertools

import pytest

from cliffscan.services.perception.handover import IN_TIME, SETTLED, Handover

PERIOD, WORK = 1 / 30, 0.01  # [s]


class Drive:
    """Frames, a robot that takes WORK for its scan of one, and a workstation whose scans come `late` [s], or never."""

    def __init__(self, late=0.05, every=1):
        self.late, self.every = late, every  # the workstation sees one frame of so many
        self.handover = Handover()
        self.published = []  # (time, frame, whose)
        self.now, self._seq, self._events = 0.0, 0, []

    def run(self, seconds):
        end = self.now + seconds
        while self.now < end:
            self._do(until=self.now)
            if self.handover.frame(self._seq, self.now):
                self._events.append((self.now + WORK, self._seq, "robot"))
            if self.late is not None and self._seq % self.every == 0:
                self._events.append((self.now + self.late, self._seq, "workstation"))
            self._seq += 1
            self.now += PERIOD
        return self

    def _do(self, until):
        self._events.sort()
        while self._events and self._events[0][0] <= until:
            at, seq, whose = self._events.pop(0)
            if self.handover.answer(seq) if whose == "robot" else self.handover.offer(seq, at):
                self.published.append((at, seq, whose))

    def whose(self, since):
        return {whose for at, _, whose in self.published if at >= since}

    def check(self):
        """Each frame once, none older than the last; the longest gap [s]."""
        frames = [seq for _, seq, _ in self.published]
        assert frames == sorted(set(frames))
        times = [at for at, _, _ in self.published]
        return max(later - at for at, later in itertools.pairwise(times))


def test_a_robot_alone_answers_every_frame():
    drive = Drive(late=None).run(3.0)
    assert drive.whose(0.0) == {"robot"}
    assert len(drive.published) == pytest.approx(90, abs=2)


def test_scans_that_come_in_time_are_published_after_a_while_and_alone():
    drive = Drive().run(5.0)
    assert drive.whose(0.0) == {"robot", "workstation"}
    assert drive.whose(SETTLED + 0.2) == {"workstation"}
    assert drive.check() < 0.1


@pytest.mark.parametrize("late", [None, 0.25, 1.5])
def test_the_robot_takes_over_within_a_third_of_a_second(late):
    drive = Drive().run(5.0)
    drive.late, began = late, drive.now
    drive.run(4.0)
    assert drive.whose(began + 0.3) == {"robot"}
    assert drive.check() < 0.3


def test_it_hands_back_when_they_come_in_time_again():
    drive = Drive().run(5.0)
    for outage in (0.1, 0.5, 3.0):
        drive.late = None
        drive.run(outage)
        drive.late, back = 0.05, drive.now
        drive.run(4.0)
        assert drive.whose(back + SETTLED + 0.4) == {"workstation"}
    assert drive.check() < 0.3


def test_a_burst_of_old_scans_after_an_outage_is_not_published():
    drive = Drive().run(5.0)
    held = range(150, 190)
    drive.late = None
    drive.run(1.5)
    assert not any(drive.handover.offer(seq, drive.now) for seq in held[:-10])
    drive.run(1.0)
    assert drive.whose(drive.now - 1.0) == {"robot"}
    drive.check()


def test_one_late_scan_puts_off_the_return():
    drive = Drive(late=0.05).run(SETTLED - 0.5)
    drive.late = IN_TIME + 0.1
    drive.run(0.1)
    drive.late = 0.05
    drive.run(SETTLED)
    assert drive.whose(0.0) == {"robot"}
    drive.run(0.5)
    assert drive.whose(drive.now - 0.1) == {"workstation"}


def test_a_workstation_that_sees_every_third_frame_is_in_time():
    drive = Drive(late=0.08, every=3).run(5.0)
    assert drive.whose(2.0) == {"workstation"}
    assert drive.check() < 0.2


def test_a_camera_that_restarts_counts_anew():
    drive = Drive().run(5.0)
    drive._seq, drive._events = 0, []
    began = len(drive.published)
    drive.run(3.0)
    assert drive.published[-1][2] == "workstation"
    assert len(drive.published) - began > 60


def test_a_scan_of_an_unknown_frame_is_nothing():
    assert not Handover().offer(5, 1.0)
    assert not Handover().answer(5)
