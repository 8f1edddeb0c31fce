"""The messages of the wire contract, each field with its unit and limits."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, model_validator

from cliffscan.common.contract import depth_codec, limits
from cliffscan.common.contract.beam_fields import Beams, check_beams
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import (
    KINECT_BASELINE,
    KINECT_NOISE,
    Camera,
    FloorPlane,
    Intrinsics,
    Region,
    check_camera,
)
from cliffscan.common.contract.message import ListAsTuple, Message, Stamp, UInt64

Side = Annotated[int, Field(ge=2, le=limits.MOST_SIDE)]  # [px]
Name = Annotated[str, limits.NAME]
Seconds = Annotated[float, limits.SECONDS]
Vector2 = Annotated[tuple[float, float], ListAsTuple]
Vector4 = Annotated[tuple[float, float, float, float], ListAsTuple]
Corners = Annotated[tuple[int, int, int, int], ListAsTuple]

State = Literal["starting", "working", "waiting"]  # waiting: for a device

TURN = 2 * math.pi
ANGLE_SLACK = 1.5  # increments: drivers of full-circle scanners disagree whether angle_max is a beam


def _whole(image: dict[str, Any]) -> Region:
    """All pixels of an image that is being read."""
    return Region.whole(image["width"], image["height"])


class DepthImage(Message):
    """A depth image with all that is needed to see it from the floor."""

    seq: UInt64
    stamp: Stamp  # time of capture
    period: Annotated[float, limits.PERIOD] = 0.0  # [s] from one frame to the next; 0: not known
    frame: Name
    width: Side
    height: Side
    encoding: Name
    data: bytes
    intrinsics: Vector4  # fx, fy, cx, cy [px]
    range: Vector2  # [m] along the optical axis
    floor: Vector4  # nx, ny, nz, d [m] in the optical frame
    noise: float = KINECT_NOISE  # [1/m] standard deviation of the inverse depth, steps included
    baseline: float = KINECT_BASELINE  # [m] between the sensor's two eyes
    region: Corners = Field(default_factory=_whole)  # first column and row, last column and row that can carry a return
    _depth: NDArray[np.uint16] = PrivateAttr()
    _camera: Camera = PrivateAttr()

    @model_validator(mode="after")
    def _unpack(self) -> Self:
        self._camera = Camera(
            self.width,
            self.height,
            Intrinsics(*self.intrinsics),
            self.range,
            FloorPlane(*self.floor),
            self.noise,
            self.baseline,
            Region.part(self.region, self.width, self.height),
        )
        check_camera(self._camera)
        self._depth = depth_codec.decode(self.data, self.encoding, self.width, self.height)
        return self

    @classmethod
    def pack(
        cls,
        seq: int,
        stamp: int,
        frame: str,
        depth: NDArray[np.uint16],
        camera: Camera,
        encoding: str,
        period: float = 0.0,
        effort: int = depth_codec.FAST,
    ) -> Self:
        """The message of a depth image (height, width) [mm], in one of the encodings of depth_codec, with an effort."""
        image = cls.model_construct(
            seq=seq,
            stamp=stamp,
            period=period,
            frame=frame,
            width=camera.width,
            height=camera.height,
            encoding=encoding,
            data=depth_codec.encode(depth, encoding, effort),
            intrinsics=camera.intrinsics,
            range=camera.range,
            floor=camera.floor,
            noise=camera.noise,
            baseline=camera.baseline,
            region=camera.region,
        )
        image._depth, image._camera = depth, camera
        return image

    @property
    def depth(self) -> NDArray[np.uint16]:
        """(height, width) [mm] along the optical axis, 0 = no return."""
        return self._depth

    @property
    def camera(self) -> Camera:
        """The camera and its place over the floor."""
        return self._camera


class ScanHeader(Message):
    """What all beams of a scan have in common."""

    seq: UInt64
    stamp: Stamp  # of the depth image
    frame: Name
    angle_min: Annotated[float, limits.AZIMUTH]  # [rad]
    angle_max: Annotated[float, limits.AZIMUTH]  # [rad]
    angle_increment: Annotated[float, limits.INCREMENT]  # [rad]
    time_increment: Annotated[float, limits.PERIOD]  # [s]
    scan_time: Annotated[float, limits.PERIOD]  # [s]
    range_min: Annotated[float, limits.RANGE_MIN]  # [m]
    range_max: Annotated[float, limits.RANGE_MAX]  # [m]


class LaserScan(Beams, ScanHeader):
    """The fields of ROS `sensor_msgs/LaserScan`; ranges follow REP-117: number, +inf (free), NaN (not seen)."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        beams = len(self.ranges)
        if not 1 <= beams <= limits.MOST_BEAMS:
            raise ValueError(f"ranges: {beams} beams, expected 1 to {limits.MOST_BEAMS}")
        check_beams(self)
        last = self.angle_min + (beams - 1) * self.angle_increment
        if not last - self.angle_min <= TURN + self.angle_increment:
            raise ValueError(f"angle_increment: {self.angle_increment} is more than a turn for {beams} beams")
        if abs(last - self.angle_max) > ANGLE_SLACK * self.angle_increment:
            raise ValueError(f"angle_max: {self.angle_max}, expected {last} for {beams} beams")
        if self.range_min > self.range_max:
            raise ValueError(f"range_max: {self.range_max} is below range_min {self.range_min}")
        return self

    def grid(self) -> Grid:
        """The beams' azimuths."""
        return Grid(len(self.ranges), self.angle_min, self.angle_increment)

    def free(self) -> NDArray[np.float64]:
        """How far [m] each beam shows floor to drive on: (beams,), no farther than its number and range_max."""
        return np.fmin(np.fmin(self.up_to("clear").astype(np.float64), self.ranges), self.range_max)


class ServiceStatus(Message):
    """How a service fares, once a second."""

    stamp: Stamp
    service: Name
    version: Name
    state: State
    pid: UInt64
    uptime: Seconds
    rate: Annotated[float, limits.FREQUENCY]  # [Hz] of its main output over the last second
    latency: Annotated[tuple[Seconds, Seconds], ListAsTuple]  # p50, p99 from capture to output, of the last 300, or 0
    counts: Annotated[dict[Name, UInt64], limits.COUNTERS]  # since the start
    note: Annotated[str, limits.TEXT]  # what a person should know, or nothing
