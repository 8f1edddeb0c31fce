"""Sees what happens to a robot."""

from __future__ import annotations

import math

from benchmarks.falls.outcome import Event, Kind
from services.kobuki.sensors import Core
from simulator.robot import RobotSimulation
from simulator.world import Pose

STRANDED = 60.0  # [s] in one place, after which the robot will not get away any more
PLACE, TURN = 0.10, math.radians(20.0)  # [m] and [rad] within which it is one place


class Watch:
    """Notes every event of a run. over: whether the run cannot go on."""

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.over = False
        self._cliff, self._bumps = False, 0
        self._left, self._left_at = Pose(), 0.0

    def look(self, robot: RobotSimulation, core: Core | None) -> None:
        """Look at the robot; core: the last packet of its base."""
        cliff = bool(core and core.cliff)
        if cliff and not self._cliff:
            self._note("cliff", robot)
        if robot.base.bumps > self._bumps and not robot.fallen:
            self._note("bump", robot)
        self._cliff, self._bumps = cliff, robot.base.bumps
        if robot.fallen:
            self._end("fall", robot)
        elif self._stranded(robot):
            self._end("stranded", robot)

    def _stranded(self, robot: RobotSimulation) -> bool:
        x, y, yaw = robot.pose
        away = math.hypot(x - self._left.x, y - self._left.y) > PLACE
        if away or abs(math.remainder(yaw - self._left.yaw, math.tau)) > TURN:
            self._left, self._left_at = robot.pose, robot.time
        return robot.time - self._left_at > STRANDED

    def _end(self, kind: Kind, robot: RobotSimulation) -> None:
        self._note(kind, robot)
        self.over = True

    def _note(self, kind: Kind, robot: RobotSimulation) -> None:
        self.events.append(Event(kind, robot.time, *robot.pose))
