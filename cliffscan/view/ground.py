"""What the gate remembers of the floor, made again from what the gate receives.

The gate does not publish its grid. It is a function of the scans, the odometry and the camera's description, so the
gate's own code makes the same one here, of all that came since somebody began to look: the gate may know more.
"""

import math
import threading
from typing import Literal, NamedTuple

from cliffscan.common.contract.base_messages import BaseState, Odometry, SafetyState
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.contact_recovery import Hit, Kind, touched
from cliffscan.safety.hull import Corners, Disc, Hull, hull_of
from cliffscan.safety.inputs import Sides
from cliffscan.safety.local_grid import HALF_CELL, KINDS, LOOK, UNKNOWN, GridWindow, RollingGrid
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.pose_history import PoseHistory
from cliffscan.safety.scan_claims import Scan, View

RADIUS = 0.18  # [m] of a body that nobody describes: a TurtleBot 2's
MARGIN = 0.03  # [m] that a gate keeps by default
SHOWN = 2.0  # [m] around the robot
DIFFERENT = 0.15  # [m] by which two ways are not to the same thing
JUMP = 0.5  # [m] between two odometries: it was reset, and nothing fits any more
Side = Literal["left", "centre", "right"]
SIDES: tuple[Side, ...] = ("left", "centre", "right")
HOLDING = ("obstacle", "limit")  # rules by which something on the floor holds the robot back


class Obstruction(NamedTuple):
    """The cell that the robot's way meets first, in the odometry's frame."""

    x: float  # [m]
    y: float
    kind: str  # as the gate calls it


class RememberedGround:
    """Safe to use from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._history = PoseHistory()
        self._view = View.undescribed()
        self._grid: RollingGrid | None = None
        self._pose = Pose2D(0.0, 0.0, 0.0)
        self.hull: Hull = Disc(RADIUS)
        self.footprint: Corners = ()

    def describe(self, description: RobotDescription) -> None:
        """What the camera can see, and how large the body is."""
        with self._lock:
            if description.camera is not None:
                self._view = View.of(description.camera)
            if description.body is not None:
                self.footprint = description.body.footprint
                self.hull = hull_of(description.body.radius, self.footprint)

    def move(self, odometry: Odometry) -> None:
        """The robot is where the odometry says."""
        pose = Pose2D(*odometry.pose)
        with self._lock:
            jumped = math.hypot(pose.x - self._pose.x, pose.y - self._pose.y) > JUMP
            if self._grid is None or jumped:
                self._grid, self._history = RollingGrid(pose, self.hull.outer), PoseHistory()
            self._pose = pose
            self._history.add(odometry.stamp, pose)
            self._grid.follow(pose, self.hull)

    def feel(self, state: BaseState) -> None:
        """A sensor of the base fires: what is there is not free."""
        kinds: dict[Kind, Sides] = {"cliff": state.cliffs, "bumper": state.bumpers}
        with self._lock:
            for kind, sides in kinds.items():
                for side, fires in zip(SIDES, sides, strict=True):
                    if fires and self._grid is not None:
                        self._grid.touch(touched(Hit(kind, side), self._pose, self.hull))

    def see(self, scan: LaserScan) -> Pose2D | None:
        """Take in a fused scan; where the robot was then, or None where nobody knows."""
        with self._lock:
            pose = self._history.at(scan.stamp)
            if pose is not None and self._grid is not None and len(scan.ranges) > 1:
                self._grid.see(*Scan.of(scan, self._view), pose.then(self._view.camera), self._view.floor)
            return pose

    @property
    def camera(self) -> Pose2D:
        """Where the scan's origin is on the robot."""
        return self._view.camera

    def cells(self) -> GridWindow | None:
        """What is remembered around the robot; None before the first odometry."""
        with self._lock:
            return self._grid.around(self._pose, SHOWN) if self._grid is not None else None

    def obstruction(self, safety: SafetyState) -> Obstruction | None:
        """What the commanded arc meets first, where something on the floor holds the robot back.

        None where that is not known here, because the gate saw it before anybody looked.
        """
        linear, angular = safety.asked
        with self._lock:
            if self._grid is None or safety.rule not in HOLDING or linear == 0.0:
                return None
            side = 1 if linear > 0.0 else -1
            points = self._grid.not_free(self._pose, LOOK, unknown_too=KINDS[UNKNOWN] in safety.note)
            kept = self.hull.rim + HALF_CELL + MARGIN
            met = self.hull.on_arc(points, side, angular / linear, kept, kept)
            if not abs(met.distance - safety.distance) < DIFFERENT:
                return None
            place = self._pose.to_world(points[:, met.point, None])
            return Obstruction(float(place[0, 0]), float(place[1, 0]), self._grid.kind_at(place))
