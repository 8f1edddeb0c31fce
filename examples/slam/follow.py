"""Scans find the robot's pose at the moment they were taken."""

import logging
import threading
from bisect import bisect_left
from collections import deque
from collections.abc import Callable
from operator import attrgetter
from typing import NamedTuple, TypeVar

from examples.slam.pose import Pose
from examples.slam.wire import UNDESCRIBED, Camera, Odometry, Scan, WireError, read_camera, read_odometry, read_scan

REMEMBERED = 500  # poses: ten seconds at 50 Hz
WAITING = 64  # scans that may wait: two seconds at 30 Hz
TOLD_EVERY = 100  # bad samples
RECENT = 25  # poses by which the lateness of one is judged
CATCHING_UP = 2  # poses late from which on a reader has others to read
DOUBT = 0.03  # [rad] of a heading from which on a scan is not mapped

Message = TypeVar("Message")

log = logging.getLogger(__name__)


class Sighting(NamedTuple):
    """A scan, where the robot was by odometry when it was taken, and from where on the robot."""

    scan: Scan
    pose: Pose
    camera: Camera  # that took it
    sure: bool  # whether the robot's heading is that of the scan's moment


class Trail:
    """The robot's poses by odometry over the last seconds."""

    def __init__(self) -> None:
        self._poses: deque[Odometry] = deque(maxlen=REMEMBERED)

    def add(self, odometry: Odometry) -> None:
        """Take in the newest pose; one from before the last means that the clock was set, and begins anew."""
        if self._poses and odometry.stamp <= self._poses[-1].stamp:
            self._poses.clear()
        self._poses.append(odometry)

    def reaches(self, stamp: int) -> bool:
        """Whether the pose of that time [ns], or of a later one, is known, and no late ones are still to come."""
        return bool(self._poses) and self._poses[-1].stamp >= stamp and self._late(len(self._poses) - 1) < CATCHING_UP

    def at(self, stamp: int) -> Pose | None:
        """The pose at a time [ns], between the two that are nearest; None outside the times that are known."""
        place = bisect_left(self._poses, stamp, key=attrgetter("stamp"))
        if place == len(self._poses):
            return None
        after = self._poses[place]
        if after.stamp == stamp or not place:
            return after.pose if after.stamp == stamp else None
        before = self._poses[place - 1]
        return before.pose.towards(after.pose, (stamp - before.stamp) / (after.stamp - before.stamp))

    def doubt(self, stamp: int) -> float:
        """By how much [rad] the heading at a time [ns] may be off, as poses were stamped late in a turn."""
        after = bisect_left(self._poses, stamp, key=attrgetter("stamp"))
        late = max(self._late(place) for place in (after - 1, after))
        first, last = max(after - 1 - late, 0), min(after + late, len(self._poses) - 1)
        here = self._poses[after].pose
        return max(abs(self._poses[place].pose.step_to(here).theta) for place in (first, last)) if late else 0.0

    def _late(self, place: int) -> int:
        """How many poses late the one at a place was stamped.

        Odometry is stamped when it is read. On a machine that is too slow a reader comes late and finds several poses
        at once: a gap between stamps, and then a burst. Poses are measured at even intervals, so one that is stamped
        later than those before it allow is late by the difference.
        """
        recent = [self._poses[each].stamp for each in range(max(place - RECENT, 0), place + 1)]
        if len(recent) < 3:
            return 0
        interval = (recent[-1] - recent[0]) / (len(recent) - 1)
        earliest = min(stamp + (len(recent) - 1 - number) * interval for number, stamp in enumerate(recent))
        return round((recent[-1] - earliest) / interval)


class Follower:
    """Pairs scans with odometry, whichever comes first; `receive_...` may be called from any thread."""

    def __init__(self) -> None:
        self._trail = Trail()
        self._scans: deque[Scan] = deque(maxlen=WAITING)
        self._camera = UNDESCRIBED
        self._changed = threading.Condition()
        self._bad = 0

    def receive_scan(self, payload: bytes) -> None:
        """Take in a LaserScan's bytes."""
        self._receive(payload, read_scan, self._scans.append)

    def receive_odometry(self, payload: bytes) -> None:
        """Take in an Odometry's bytes."""
        self._receive(payload, read_odometry, self._trail.add)

    def receive_description(self, payload: bytes) -> None:
        """Take in a RobotDescription's bytes."""
        self._receive(payload, read_camera, self._describe)

    def next(self, timeout: float) -> Sighting | None:
        """The next scan whose pose is known, in order of arrival; None where there is none within `timeout` [s].

        A scan from before the first pose is dropped, and so is the oldest where too many wait.
        """
        with self._changed:
            return self._changed.wait_for(self._take, timeout)

    def _take(self) -> Sighting | None:
        while self._scans and self._trail.reaches(self._scans[0].stamp):
            scan = self._scans.popleft()
            pose = self._trail.at(scan.stamp)
            if pose:
                return Sighting(scan, pose, self._camera, self._trail.doubt(scan.stamp) < DOUBT)
        return None

    def _describe(self, camera: Camera | None) -> None:
        self._camera = camera or self._camera

    def _receive(self, payload: bytes, read: Callable[[bytes], Message], take: Callable[[Message], None]) -> None:
        """Have a message taken in; a bad one is dropped and counted."""
        try:
            message = read(payload)
        except WireError as error:
            if self._bad % TOLD_EVERY == 0:
                log.warning("dropped a bad sample, number %d: %s", self._bad + 1, error)
            self._bad += 1
            return
        with self._changed:
            take(message)
            self._changed.notify()
