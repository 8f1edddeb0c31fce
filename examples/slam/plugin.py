"""What every plug-in does: scans go into a mapper, poses and maps come out, and the map is saved at the end."""

import logging
import math
import signal
import sys
import time
from collections.abc import Callable
from types import FrameType
from typing import Protocol

import zenoh

from examples.slam import map_files
from examples.slam import settings as command_line
from examples.slam.follow import Follower, Sighting
from examples.slam.network import Network
from examples.slam.pose import Pose
from examples.slam.settings import Settings
from examples.slam.wire import Map, Scan

MAP_PERIOD = 1.0  # [s] between two maps, at least
PATIENCE = 0.1  # [s] a wait may last before the plug-in looks whether it should end
RETRY = 0.5  # [s] between two attempts to reach a router

log = logging.getLogger(__name__)


class Mapper(Protocol):
    """What makes a map of scans."""

    def add(self, scan: Scan, odometry: Pose, near: float) -> Pose:
        """Take in a scan, its origin by odometry, and how near [m] it shows floor; where it was on the map."""

    def follow(self, odometry: Pose) -> Pose:
        """Where the origin of a scan that is not taken in was on the map."""

    def map(self) -> Map:
        """The map so far."""


class Stop:
    """Asked for by SIGTERM and Ctrl-C."""

    def __init__(self) -> None:
        self.asked = False
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._on_signal)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self.asked = True


class Pace:
    """Says when something that has to be done may be done, at most once in so many seconds."""

    def __init__(self, period: float) -> None:
        self._period = period
        self._next = time.monotonic()

    def due(self) -> bool:
        """Whether it may be done now; if so, the next time is a period from now."""
        now = time.monotonic()
        if now < self._next:
            return False
        self._next = now + self._period
        return True


class Plugin:
    """Works off scans; knows what of the map was not yet published and not yet saved."""

    def __init__(self, settings: Settings, mapper: Mapper, network: Network) -> None:
        self._settings = settings
        self._mapper, self._network = mapper, network
        self._publishing, self._saving = Pace(MAP_PERIOD), Pace(settings.every or math.inf)
        self._saving.due()  # not at once
        self._newest = self._published = self._saved = 0  # [ns] stamp of the newest scan, when published, when saved

    def take(self, sighting: Sighting) -> None:
        """Map a scan whose place is sure, and publish where the robot is."""
        scan, robot, camera, sure = sighting
        place = self._settings.origin or camera.place
        near = camera.nearest_floor if self._settings.near is None else self._settings.near
        odometry = robot.then(place)
        origin = self._mapper.add(scan, odometry, near) if sure else self._mapper.follow(odometry)
        self._network.publish_pose(origin.then(place.step_to(Pose())), scan.stamp)
        self._newest = scan.stamp

    def publish(self) -> None:
        """Publish the map and save it, where there is something new on it and it is time."""
        if self._newest != self._published and self._publishing.due():
            grid = self._mapper.map()
            if grid.cells.size:
                self._network.publish_map(grid, self._newest)
            self._published = self._newest
        if self._newest != self._saved and self._saving.due():
            self.save()

    def save(self) -> None:
        """Save the map, where files are wanted. Raises OSError."""
        grid = self._mapper.map()
        if self._settings.out and grid.cells.size:
            map_files.save(grid, self._settings.out)
            log.info("map saved in %s", self._settings.out)
        self._saved = self._newest


def main(program: str, text: str | None, make: Callable[[Settings], Mapper]) -> None:
    """Run a plug-in from the command line until SIGTERM or Ctrl-C; what prevents it is reported in one line."""
    settings = command_line.read(program, text)
    logging.basicConfig(level=logging.INFO, format=f"%(asctime)s %(levelname)s {program}: %(message)s")
    try:
        if settings.out:
            settings.out.mkdir(parents=True, exist_ok=True)
        _run(settings, make(settings), Stop())
    except (OSError, ImportError) as error:
        sys.stderr.write(f"{program}: {error}\n")
        sys.exit(2)


def _run(settings: Settings, mapper: Mapper, stop: Stop) -> None:
    network = _connect(settings, stop)
    if network is None:
        return
    with network:
        plugin, follower = Plugin(settings, mapper, network), Follower()
        network.feed(follower)
        log.info("ready")
        while not stop.asked:
            sighting = follower.next(PATIENCE)
            if sighting:
                plugin.take(sighting)
            plugin.publish()
        plugin.save()


def _connect(settings: Settings, stop: Stop) -> Network | None:
    """The network, as soon as a router answers; None where the process was asked to end before that."""
    logged = False
    while not stop.asked:
        try:
            return Network(settings)
        except zenoh.ZError as error:
            if not logged:
                log.info("waiting for a router: %s", str(error).split(" at /")[0])
                logged = True
            time.sleep(RETRY)
    return None
