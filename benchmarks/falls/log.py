"""What is noted of a run while it goes on."""

import numpy as np

from benchmarks.falls.cases import Case
from benchmarks.falls.floor import Floor, arc
from benchmarks.falls.outcome import Outcome, Point
from benchmarks.falls.watch import Watch
from cliffscan.safety.rules import CRAWL, Decision
from cliffscan.simulator.world import Pose, World

POINT_PERIOD = 0.1  # [s] between two points of the track
AHEAD = 0.5  # [m] of a commanded arc that must be free for a hold to be without cause


class Log:
    """A run in a world: where the robot was, when the gate held it, what happened to it."""

    def __init__(self, case: Case, world: World) -> None:
        self.floor = Floor(world)
        self.watch = Watch()
        self.track: list[Point] = []
        self._case = case
        self._held = self._idle = 0.0  # [s]
        self._point_due = 0.0

    def drove(self, now: float, pose: Pose, decision: Decision, seconds: float) -> None:
        """For so long [s] until now, the gate did that to the driver's wish."""
        held = abs(decision.asked.linear) >= CRAWL > abs(decision.allowed.linear)
        idle = held and self.floor.clear(arc(pose, *decision.asked, AHEAD))
        self._held += seconds * held
        self._idle += seconds * idle
        if now >= self._point_due:
            self._point_due += POINT_PERIOD
            self.track.append(Point(now, *pose, decision.rule, idle))

    def outcome(self, seconds: float, wall: float) -> Outcome:
        """What came of it; seconds: simulated, wall: on the clock."""
        places = np.array([(point.x, point.y) for point in self.track])
        visited = self.floor.visited(places)
        return Outcome(
            self._case, seconds, wall, tuple(self.watch.events), self.floor.area, visited, self._held, self._idle
        )
