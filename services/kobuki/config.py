"""The configuration of kobuki."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from cliffscan.common.runtime.config import ServiceConfig
from cliffscan.safety.local_grid import Pose

Seconds = Annotated[float, Field(gt=0, le=5)]


class KobukiConfig(ServiceConfig):
    """The port, how fast the robot may be, and what keeps it safe."""

    port: str = "/dev/kobuki"

    # how fast it may be
    max_linear: Annotated[float, Field(gt=0, le=0.70)] = 0.70  # [m/s]
    max_angular: Annotated[float, Field(gt=0, le=110)] = 110.0  # [deg/s] beyond, the gyro degrades
    acceleration: Annotated[float, Field(gt=0, le=5)] = 0.5  # [m/s²]
    angular_acceleration: Annotated[float, Field(gt=0, le=2000)] = 200.0  # [deg/s²]

    # when it must stop
    command_timeout: Seconds = 0.3  # [s] without a command
    stamp_tolerance: Seconds = 0.5  # [s] by which a command's stamp may differ from this clock
    require_scan: bool = True  # without a fresh fused scan it only turns, slowly
    scan_timeout: Seconds = 0.3  # [s] since the scan was taken, and since it came
    slow_turn: Annotated[float, Field(ge=0, le=110)] = 30.0  # [deg/s] without a scan

    # what it can collide with, and how it brakes
    robot_radius: Annotated[float, Field(gt=0, le=1)] = 0.18  # [m]
    margin: Annotated[float, Field(ge=0, le=1)] = 0.03  # [m] kept from what is in the way
    deceleration: Annotated[float, Field(gt=0, le=5)] = 0.6  # [m/s²] it brakes with, at the least
    # [s] from a decision to its effect: about 0.2 s of the base's own, a packet's age, and 0.02 s to the next decision;
    # the age of the scan is measured and added
    reaction: Seconds = 0.25

    # where the scans are taken from, seen from the middle between the wheels
    camera_x: float = -0.087  # [m] ahead: the Kinect of a TurtleBot 2 stands behind
    camera_y: float = 0.0  # [m] to the left
    camera_yaw: float = 0.0  # [deg] counter-clockwise
    blind: Annotated[float, Field(ge=0, le=1.4)] = 0.75  # [m] nearer than this the camera sees no floor
    start_free: Annotated[float, Field(ge=0, le=1.4)] = 0.5  # [m] around the place where the robot was put down

    def camera(self) -> Pose:
        """Where the scans are taken from."""
        return Pose(self.camera_x, self.camera_y, math.radians(self.camera_yaw))
