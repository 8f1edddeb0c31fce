"""Drives to and fro between a drop and a wall by the robot's true place, so that no fault misleads the driver."""

import random

from cliffscan.simulator.world import Pose
from evaluation.processes.steering import LINEAR, Command, To

WORLD = "landing"
START = Pose(0.0, 0.2, 0.0)
EDGE = 3.0  # [m] x of the stairs' edge
ENDS = (To(EDGE - 0.45, 0.2), To(-0.9, 0.2))  # the other one is 0.6 m before the wall
SPEEDS = (0.2, 0.3, 0.5)  # [m/s]


class Shuttle:
    """Knows which end is next, and how fast to go there."""

    def __init__(self, rng: random.Random) -> None:
        self._rng = rng
        self._end = 0
        self.speed = rng.choice(SPEEDS)  # [m/s]

    def command(self, pose: Pose) -> Command:
        """What to do at this pose; at an end it turns round."""
        asked = ENDS[self._end].command(pose)
        if asked is None:
            self._end, self.speed = 1 - self._end, self._rng.choice(SPEEDS)
            asked = ENDS[self._end].command(pose) or (0.0, 0.0)
        linear, angular = asked
        return linear * self.speed / LINEAR, angular
