"""A map by yag-slam: scans are matched, loops are closed, and odometry only shows where to begin."""

from typing import Any, NamedTuple

import numpy as np

from examples.slam import plugin
from examples.slam.beams import Beams, beams
from examples.slam.occupancy import OccupancyGrid
from examples.slam.pose import Pose
from examples.slam.settings import Settings
from examples.slam.wire import Map, Scan

STEP, TURN = 0.3, 0.17  # [m], [rad] the robot moves between two scans that are matched
# Odometry that is read late is behind a robot that turns, by an angle that a match cannot take back. So few scans of a
# fast turn are matched, only as many as overlap, and one more as soon as it is over.
FAST, FAR_TURN = 0.35, 0.5  # [rad/s], [rad]
ENOUGH = 0.1  # share of the beams that must hit something, or there is nothing to match
# A narrow view slides along walls and turns with them, so a pose far from odometry's must match much better; as
# delivered, the least penalties are near 1, which makes all poses equal. Coarser settings crash (0.3 m at 0.02 m).
STEP_MATCH = {
    "search_size": 0.2,  # [m]
    "resolution": 0.01,  # [m]
    "smear_deviation": 0.02,  # [m]
    "coarse_search_angle_offset": 0.28,  # [rad] a slow machine's odometry is some 0.1 rad behind a robot that turns
    "distance_variance_penalty": 0.003,
    "minimum_distance_penalty": 0.3,
    "angle_variance_penalty": 0.005,
    "minimum_angle_penalty": 0.5,
}
ALIKE = 0.03  # response below which a scan has nothing in common with those before: a good one has 0.07 or more
UNSURE = np.diag([1e-5, 1e-5, 1e-6])  # [m², m², rad²] variances of the steps in which matches are sought
LOOP_MATCH = {"search_size": 2.0, "resolution": 0.05}  # [m]
COARSE, FINE = 0.45, 0.6  # responses from which on a loop is closed
INSTALL = "this plug-in needs yag-slam, which is under the GPL: pip install yag-slam opencv-python-headless"


class Look(NamedTuple):
    """A scan on the map: it stays beside the matched scan that came before it, wherever that is moved."""

    key: Any  # yag-slam's scan
    step: Pose  # from the matched scan to this one, by odometry
    seen: Beams
    near: float  # [m]


class YagMapper:
    """Matches a scan every few steps; between them, odometry leads on from the last one matched."""

    def __init__(self, settings: Settings) -> None:
        """Raises ImportError where yag-slam is not installed."""
        self._settings = settings
        self._slam = _graph(settings.reach)
        self._key: Any = None
        self._key_odometry = self._last = Pose()  # of the last scan that was matched, and of the last on the map
        self._before: tuple[int, Pose] | None = None  # stamp [ns] and odometry of the last scan
        self._matched_fast = False  # whether the robot turned fast when the last scan was matched
        self._looks: list[Look] = []
        self._grid, self._drawn = OccupancyGrid(settings.resolution), 0

    def add(self, scan: Scan, odometry: Pose, near: float) -> Pose:
        """Take in a scan; its origin on the map, which begins where odometry began."""
        fast = self._turns_fast(scan.stamp, odometry)
        if self._key is None or self._is_due(self._last.step_to(odometry), fast):
            self._look(beams(scan, self._settings.reach), scan, odometry, near)
            self._matched_fast = fast
        return self.follow(odometry)

    def follow(self, odometry: Pose) -> Pose:
        """A scan's origin on the map, by odometry from the last scan that was matched."""
        if self._key is None:
            return odometry
        return _pose(self._key).then(self._key_odometry.step_to(odometry))

    def map(self) -> Map:
        """The map so far, drawn anew where a loop was closed."""
        for key, step, seen, near in self._looks[self._drawn :]:
            self._grid.draw(seen, _pose(key).then(step), near)
        self._drawn = len(self._looks)
        return self._grid.map()

    def _turns_fast(self, stamp: int, odometry: Pose) -> bool:
        before, self._before = self._before, (stamp, odometry)
        if before is None or before[0] >= stamp:
            return False
        return abs(before[1].step_to(odometry).theta) > FAST * (stamp - before[0]) * 1e-9

    def _is_due(self, step: Pose, fast: bool) -> bool:
        """Whether a scan is matched that lies a step from the last one."""
        if fast:
            return abs(step.theta) >= FAR_TURN
        return self._matched_fast or _moved(step)

    def _look(self, seen: Beams, scan: Scan, odometry: Pose, near: float) -> None:
        if self._key is None or seen.hit.mean() >= ENOUGH:
            self._match(seen, scan, odometry)
        self._looks.append(Look(self._key, self._key_odometry.step_to(odometry), seen, near))
        self._last = odometry

    def _match(self, seen: Beams, scan: Scan, odometry: Pose) -> None:
        self._key, self._key_odometry = _key_scan(seen, scan, odometry, self._settings.reach), odometry
        _, closed = self._slam.process_scan(self._key)
        if closed:  # all poses have changed
            self._grid, self._drawn = OccupancyGrid(self._settings.resolution), 0


class SureMatcher:
    """Matches as yag-slam does, but lets a scan that resembles none stay where odometry led.

    yag-slam takes the best of all poses even where none is good, as after a turn into what was never seen, and the
    heading may then be off by as much as it searches. A covariance is never singular, or yag-slam could not use it.
    """

    def __init__(self, matcher: Any) -> None:  # noqa: ANN401
        self._matcher = matcher

    def match_scan(self, query: Any, base_scans: Any, penalty: bool, do_fine: bool) -> Any:  # noqa: ANN401
        """Match a scan with those before it; see yag_slam.scan_matching."""
        found = self._matcher.match_scan(query, base_scans, penalty, do_fine)
        pose = found.best_pose if found.response >= ALIKE else query.corrected_pose
        return found._replace(best_pose=pose, covariance=np.array(found.covariance) + UNSURE)


class LoopMatcher:
    """Finds a loop by a coarse match, and only where a fine one agrees: yag-slam would close it either way."""

    def __init__(self, coarse: Any, fine: Any) -> None:  # noqa: ANN401
        self._coarse, self._fine = coarse, fine

    def match_scan(self, query: Any, base_scans: Any, penalty: bool, do_fine: bool) -> Any:  # noqa: ANN401
        """Match a scan with those of long ago; the response is 0 where it is no loop."""
        found = self._coarse.match_scan(query, base_scans, penalty, do_fine)
        if found.response < COARSE:
            return found
        there = query.copy()
        there.corrected_pose = found.best_pose
        sure = self._fine.match_scan(there, base_scans, penalty, True).response >= FINE
        return found if sure else found._replace(response=0.0)


def _moved(step: Pose) -> bool:
    return step.x**2 + step.y**2 >= STEP**2 or abs(step.theta) >= TURN


def _pose(key: Any) -> Pose:  # noqa: ANN401 - yag-slam has no types
    place = key.corrected_pose
    return Pose(place.x, place.y, place.euler[-1])


def _key_scan(seen: Beams, scan: Scan, odometry: Pose, reach: float) -> Any:  # noqa: ANN401
    """A scan as yag-slam takes it: all ranges finite, those beyond its threshold are no obstacles."""
    from yag_slam.models import LocalizedRangeScan

    ranges = np.where(seen.hit, seen.ends, reach + 1.0)
    first, last = seen.angles[0], seen.angles[-1]
    return LocalizedRangeScan(ranges, first, last, scan.angle_increment, 0.0, reach, reach, *odometry)


def _graph(reach: float) -> Any:  # noqa: ANN401
    """yag-slam, set for a camera's narrow scan. Raises ImportError."""
    try:
        from yag_slam.graph_slam import GraphSlam
        from yag_slam.scan_matching import Scan2DMatcherCpp
    except ImportError as error:
        raise ImportError(f"{error}; {INSTALL}") from error
    fine = SureMatcher(Scan2DMatcherCpp(STEP_MATCH | {"range_threshold": reach}))
    coarse = Scan2DMatcherCpp(LOOP_MATCH | {"range_threshold": reach}, loop=True)
    return GraphSlam(
        fine, LoopMatcher(coarse, fine), scan_buffer_len=60, min_response_coarse=COARSE, min_response_fine=FINE
    )


if __name__ == "__main__":
    plugin.main("yag", __doc__, YagMapper)
