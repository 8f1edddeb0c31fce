"""A drive and what is mapped on it: the robot is led along its steps, maps and poses are kept."""

from collections.abc import Collection, Sequence

from cliffscan.common.contract.base_messages import Odometry, Triple, Velocity
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.topics import MAP, ODOMETRY, POSE
from cliffscan.common.runtime.bus import Publisher
from evaluation.processes.steering import Driver, Step

COMMAND_PERIOD = 80_000_000  # [ns]


class Survey:
    """Receives all, drives when asked to; done when the steps are, and the maps show what was seen until then."""

    unit = "steps and maps"
    patience = 60.0  # [s]

    def __init__(self, steps: Sequence[Step], maps: Collection[str], publisher: Publisher[Velocity]) -> None:
        """`maps`: the names of the maps."""
        self.driver = Driver(steps)
        self.total = len(steps) + len(maps)
        self.maps: dict[str, list[OccupancyGrid]] = {name: [] for name in maps}
        self.poses: dict[str, dict[int, Triple]] = {name: {} for name in maps}  # by stamp [ns]
        self._publisher = publisher
        self._commanded = self._ended = 0  # [ns]

    @property
    def paths(self) -> list[str]:
        """What to receive."""
        own = [f"{topic.path}/{name}" for topic in (MAP, POSE) for name in self.maps]
        return [ODOMETRY.path, *own]

    @property
    def done(self) -> int:
        """How many of the steps and maps are."""
        drawn = [grids for grids in self.maps.values() if grids and self._ended and grids[-1].stamp >= self._ended]
        return self.driver.done + len(drawn)

    def receive(self, path: str, payload: bytes, go: bool) -> None:
        """Take in what was published on a path; drive on if `go`."""
        if path == ODOMETRY.path and go:
            self._drive(Odometry.decode(payload))
        elif path.startswith(MAP.path + "/"):
            self.maps[path.removeprefix(MAP.path + "/")].append(OccupancyGrid.decode(payload))
        elif path.startswith(POSE.path + "/"):
            pose = Pose2D.decode(payload)
            self.poses[path.removeprefix(POSE.path + "/")][pose.stamp] = pose.pose

    def _drive(self, odometry: Odometry) -> None:
        if odometry.stamp - self._commanded < COMMAND_PERIOD or self._ended:
            return
        self._commanded = odometry.stamp
        linear, angular = self.driver.command(odometry.pose, odometry.stamp)
        self._publisher.put(Velocity(stamp=odometry.stamp, linear=linear, angular=angular))
        if self.driver.finished:
            self._ended = odometry.stamp
