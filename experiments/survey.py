"""A drive and all that is published on it: the robot is led along its steps, maps, poses and some frames are kept."""

from collections.abc import Sequence

from cliffscan.common.contract.base_messages import Odometry, Triple, Velocity
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import DEPTH, MAP, ODOMETRY, POSE
from cliffscan.common.runtime.bus import Publisher
from evaluation.processes.steering import Driver, Step
from experiments.frames import Frame, Gathering

COMMAND_PERIOD = 80_000_000  # [ns]
FRAME_PERIOD = 400_000_000  # [ns] between two frames that are kept


class Survey:
    """Receives all, drives when asked to; done when the steps are, and the maps show what was seen until then."""

    unit = "steps and maps"
    patience = 60.0  # [s]

    def __init__(self, steps: Sequence[Step], scans: dict[str, str], publisher: Publisher[Velocity]) -> None:
        """`scans`: the path of the scan of each map by the map's name."""
        self.driver = Driver(steps)
        self.total = len(steps) + len(scans)
        self.maps: dict[str, list[OccupancyGrid]] = {name: [] for name in scans}
        self.poses: dict[str, dict[int, Triple]] = {name: {} for name in scans}  # by stamp [ns]
        self.frames: list[Frame] = []  # FRAME_PERIOD apart
        self._publisher = publisher
        self._gathering = Gathering({path: name for name, path in scans.items()})
        self._scans = set(scans.values())
        self._commanded = self._ended = 0  # [ns]

    @property
    def paths(self) -> list[str]:
        """What to receive."""
        own = [f"{topic.path}/{name}" for topic in (MAP, POSE) for name in self.maps]
        return [ODOMETRY.path, DEPTH.path, *self._scans, *own]

    @property
    def done(self) -> int:
        """How many of the steps and maps are."""
        drawn = [grids for grids in self.maps.values() if grids and self._ended and grids[-1].stamp >= self._ended]
        return self.driver.done + len(drawn)

    def receive(self, path: str, payload: bytes, go: bool) -> None:
        """Take in what was published on a path; drive on if `go`."""
        if path == ODOMETRY.path and go:
            self._drive(Odometry.decode(payload))
        elif path in self._scans or path == DEPTH.path:
            self._keep(self._gathering.take(path, (DepthImage if path == DEPTH.path else LaserScan).decode(payload)))
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

    def _keep(self, frame: Frame | None) -> None:
        if frame and (not self.frames or frame.image.stamp - self.frames[-1].image.stamp >= FRAME_PERIOD):
            self.frames.append(frame)
