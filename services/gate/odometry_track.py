"""The base's odometry as the gate needs it: one that never jumps, and what in it cannot be."""

import math
from typing import NamedTuple

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.safety.base_clock import (
    LONGEST_INCREMENT,
    LONGEST_SILENCE,
    SLACK,
    ClockLead,
    Contradiction,
    Discontinuity,
)
from cliffscan.safety.inputs import Motion, SafetyLimits
from cliffscan.safety.pose2d import Pose2D

WHEEL_SEPARATION = 0.3  # [m] between two points, left and right of the middle, that stand for the base's wheels
LEAP = 2.0  # times as far as the base may get is no motion
HERE = Pose2D(0.0, 0.0, 0.0)


class Overtaken(Contradiction):
    """A message is older than the last one."""


class Step(NamedTuple):
    """Where the robot is after a message, and how far it has gone; see safety/inputs.BaseReport."""

    pose: Pose2D
    motion: Motion | None
    new_baseline: str = ""
    contradiction: bool = False
    unmeasured: float = 0.0


class OdometryTrack:
    """Follows the base's odometry from message to message.

    Where one does not go on from the last, as when the base was started anew, the robot stays where it was.
    """

    def __init__(self, limits: SafetyLimits) -> None:
        self._fastest, self._fastest_turn = LEAP * limits.max_linear, LEAP * limits.max_angular
        self._origin = self._pose = HERE  # of the base's odometry, and the robot, in a frame that never jumps
        self._before: tuple[Odometry, float] | None = None  # the last message, and when it came [s]
        self._motion = Motion(0.0, 0.0, 0.0)
        self._lead = ClockLead()

    def update(self, message: Odometry, now: float) -> Step | None:
        """Take in a message that came at `now` [s]; None where its clock stands still, so that nothing is new."""
        raw = Pose2D(*message.pose)
        before, self._before = self._before, (message, now)
        try:
            motion = self._increment(before, message, now)
        except Overtaken as late:
            self._before = before
            return Step(self._pose, None, str(late), contradiction=True)
        except Discontinuity as gap:
            self._origin = self._pose.then(HERE.seen_from(raw))
            self._motion = Motion(0.0, 0.0, 0.0)
            if not isinstance(gap, Contradiction):
                self._lead.interrupted()
            return Step(self._pose, None, str(gap), isinstance(gap, Contradiction), _between(before, message, now))
        if motion is None:
            self._before = before
            return None
        self._motion, self._pose = motion, self._origin.then(raw)
        return Step(self._pose, motion)

    def _increment(self, before: tuple[Odometry, float] | None, message: Odometry, now: float) -> Motion | None:
        """How far the base has gone now. Raises Discontinuity."""
        if before is None:
            raise Discontinuity("first odometry")
        last, came = before
        silence, seconds = now - came, (message.stamp - last.stamp) * 1e-9
        if seconds == 0.0:
            return None
        if silence > LONGEST_SILENCE or seconds > LONGEST_INCREMENT:
            raise Discontinuity(f"{max(silence, seconds):.2f} s between two messages of odometry")
        if seconds < 0.0:
            raise Overtaken(f"its stamp went back by {-seconds:.3f} s")
        step = Pose2D(*message.pose).seen_from(Pose2D(*last.pose))
        way, turn = math.hypot(step.x, step.y), math.remainder(step.theta, math.tau)
        room = seconds + SLACK
        if way > self._fastest * room or abs(turn) > self._fastest_turn * room:
            raise Contradiction(f"the robot leapt by {way:.2f} m and {math.degrees(turn):.0f} deg in {seconds:.3f} s")
        self._lead.passed(seconds, silence)
        ahead = step.x * math.cos(turn / 2.0) + step.y * math.sin(turn / 2.0)
        half = turn * WHEEL_SEPARATION / 2.0
        clock, left, right, _ = self._motion
        return Motion(clock + seconds, left + ahead - half, right + ahead + half)


def _between(before: tuple[Odometry, float] | None, message: Odometry, now: float) -> float:
    """How much time [s] may have passed since a message, by whichever clock says more; infinite at first."""
    return max(abs(message.stamp - before[0].stamp) * 1e-9, now - before[1]) if before else math.inf
