"""What makes a scan of a depth image: the grid and limits that are configured, and the message that comes of it."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from cliffscan.common.contract import limits
from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Camera, reach
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.config import ServiceConfig

UNSURE_SLOPE = 1.8  # [deg] by which a slope may look steeper than it is
FRAME = "camera_footprint"  # on the floor below the camera
WARMUP_IMAGE = DepthImage(  # a frame in which nothing was seen: what kernels are compiled on
    seq=0,
    stamp=0,
    frame="",
    width=2,
    height=2,
    encoding=RAW,
    data=bytes(8),
    intrinsics=(2.0, 2.0, 0.5, 0.5),
    range=(0.5, 4.5),
    floor=(0.0, -1.0, 0.0, 0.3),
)


class ScanConfig(ServiceConfig):
    """What positive and negative agree on: the beams and limits of scans, and what is floor."""

    TABLE: ClassVar[str] = "scan"

    beams: Annotated[int, Field(ge=2, le=limits.MOST_BEAMS)] = 640
    """Number of beams of a scan."""
    field_of_view: Annotated[float, Field(gt=0, lt=180)] = 58.0
    """Angle [deg] between the first and the last beam."""
    range_max: Annotated[float, limits.RANGE_MAX] = 10.0
    """Largest distance [m] that is reported."""
    scan_time: Annotated[float, limits.PERIOD] = 1 / 30
    """Time [s] between two scans of a camera that does not tell its own."""
    floor_band: Annotated[float, Field(gt=0, le=0.5)] = 0.03
    """Height [m] above and below the plane that counts as floor."""
    steepest: Annotated[float, Field(ge=0, le=20)] = 5.0
    """Slope [deg] up to which a ramp is floor."""
    wheel_step: Annotated[float, Field(ge=0, le=0.1)] = 0.012
    """Height [m] of the highest step that the wheels take, a Kobuki's by default; within 2 m a higher one is in the
    way, or an edge, where the sensor shows it surely. 0 = steps lower than floor_band and least_drop are floor."""

    @model_validator(mode="after")
    def _wide_enough(self) -> Self:
        if self.grid().increment < limits.FINEST_INCREMENT:
            raise ValueError(f"field_of_view {self.field_of_view} is too narrow for {self.beams} beams")
        return self

    def grid(self) -> Grid:
        """The beams."""
        half = math.radians(self.field_of_view) / 2
        return Grid.between(self.beams, -half, half)

    def steepest_rise(self) -> float:
        """Rise per metre of the steepest ramp, as it may look at most."""
        return math.tan(math.radians(self.steepest + UNSURE_SLOPE))


class ImageScanConfig(ScanConfig):
    """What positive and negative each have of their own, too."""

    range_min: Annotated[float, limits.RANGE_MIN] = 0.0
    """Least distance [m] that is reported; nearer points are parts of the robot itself."""

    @model_validator(mode="after")
    def _limits(self) -> Self:
        if self.range_min >= self.range_max:
            raise ValueError(f"range_max {self.range_max} is not above range_min {self.range_min}")
        return self

    def reach(self, camera: Camera) -> float:
        """How far [m] a scan reports: range_max, but no farther than the sensor."""
        return max(self.range_min, min(self.range_max, reach(camera)))


def laser_scan(image: DepthImage, beams: Beams, config: ImageScanConfig) -> LaserScan:
    """The message with the `beams` of `image`, none of them beyond config.reach of its camera."""
    grid = config.grid()
    return LaserScan(
        seq=image.seq,
        stamp=image.stamp,
        frame=FRAME,
        angle_min=grid.angle_min,
        angle_max=grid.angle_max,
        angle_increment=grid.increment,
        time_increment=0.0,
        scan_time=image.period or config.scan_time,
        range_min=config.range_min,
        range_max=config.reach(image.camera),
        **beams.arrays(),
    )
