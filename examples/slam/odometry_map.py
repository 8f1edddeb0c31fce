"""A map by odometry's poses alone: nothing corrects them, so it is as good as the wheels are."""

from examples.slam import plugin
from examples.slam.beams import beams
from examples.slam.occupancy import OccupancyGrid
from examples.slam.pose import Pose
from examples.slam.settings import Settings
from examples.slam.wire import Map, Scan


class OdometryMapper:
    """Draws every scan where odometry has it that it was taken."""

    def __init__(self, settings: Settings) -> None:
        self._reach = settings.reach
        self._grid = OccupancyGrid(settings.resolution)

    def add(self, scan: Scan, odometry: Pose, near: float) -> Pose:
        """Draw a scan; its origin on the map is that by odometry."""
        self._grid.draw(beams(scan, self._reach), odometry, near)
        return odometry

    def follow(self, odometry: Pose) -> Pose:
        """The same place: nothing corrects it."""
        return odometry

    def map(self) -> Map:
        """The map so far."""
        return self._grid.map()


if __name__ == "__main__":
    plugin.main("odometry_map", __doc__, OdometryMapper)
