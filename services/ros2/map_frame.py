"""Where odom stands on the map: a SLAM's pose without the odometry of its moment (REP-105)."""

import threading

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.map_messages import Pose2D as PoseOnMap
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.pose_history import PoseHistory
from cliffscan.services.ros2.transforms import Transform, heading

ORIGIN = Pose2D(0.0, 0.0, 0.0)


class MapFrame:
    """Remembers the last odometry; safe to use from two threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._history = PoseHistory()
        self._odom = "odom"

    def moved(self, odometry: Odometry) -> None:
        """The robot is where the odometry says."""
        with self._lock:
            self._odom = odometry.frame
            self._history.add(odometry.stamp, Pose2D(*odometry.pose))

    def transform(self, pose: PoseOnMap) -> Transform | None:
        """From the map to odom, by the robot's place on it; None where the odometry of that moment is not known."""
        with self._lock:
            base = self._history.at(pose.stamp)
        if base is None:
            return None
        x, y, theta = Pose2D(*pose.pose).then(ORIGIN.seen_from(base))
        return Transform(pose.stamp, pose.frame, self._odom, (x, y, 0.0), heading(theta))
