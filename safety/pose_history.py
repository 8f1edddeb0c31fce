"""Where the robot was a moment ago: scans are older than the odometry they are put into."""

import math
from bisect import bisect_left
from collections import deque

from cliffscan.safety.pose2d import Pose2D

ROOM = 128  # poses; 2.5 s at the base's rate
AHEAD = 100_000_000  # [ns] after the last pose for which the robot is taken to go on as in so long before it


class PoseHistory:
    """The last poses with their stamps [ns]."""

    def __init__(self) -> None:
        self._stamps: deque[int] = deque(maxlen=ROOM)
        self._poses: deque[Pose2D] = deque(maxlen=ROOM)

    def add(self, stamp: int, pose: Pose2D) -> None:
        """The robot is at `pose`; what is older than the last one begins a new history.

        Packets that are read together have one stamp: the last of them holds.
        """
        if self._stamps and stamp < self._stamps[-1]:
            self._stamps.clear()
            self._poses.clear()
        elif self._stamps and stamp == self._stamps[-1]:
            self._stamps.pop()
            self._poses.pop()
        self._stamps.append(stamp)
        self._poses.append(pose)

    @property
    def full(self) -> bool:
        """Whether it reaches as far back as it ever does."""
        return len(self._stamps) == ROOM

    def at(self, stamp: int) -> Pose2D | None:
        """The pose at `stamp`, between two that are known or soon after the last; None before the first and later."""
        if not self._stamps or not self._stamps[0] <= stamp <= self._stamps[-1] + AHEAD:
            return None
        place = bisect_left(self._stamps, stamp)
        if place == len(self._stamps):
            return self._beyond_last(stamp)
        if place == 0:
            return self._poses[0]
        since = self._stamps[place - 1]
        return between(self._poses[place - 1], self._poses[place], (stamp - since) / (self._stamps[place] - since))

    def _beyond_last(self, stamp: int) -> Pose2D:
        last, since = self._poses[-1], self._stamps[-1] - AHEAD
        before = self.at(since)
        return between(before, last, (stamp - since) / AHEAD) if before else last


def between(before: Pose2D, after: Pose2D, share: float) -> Pose2D:
    """The pose after that share of the way between two, or beyond it."""
    return Pose2D(
        before.x + share * (after.x - before.x),
        before.y + share * (after.y - before.y),
        before.theta + share * math.remainder(after.theta - before.theta, math.tau),
    )
