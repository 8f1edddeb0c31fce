"""The configuration of capture."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics, Region, check_camera
from cliffscan.common.contract.description import TURTLEBOT_2, Place
from cliffscan.common.contract.limits import FARTHEST_PLACE, MOST_NOISE, WIDEST_BASELINE
from cliffscan.common.contract.message import ListAsTuple
from cliffscan.common.runtime.config import ConfigError, Profiles, ServiceConfig
from cliffscan.services.capture.sources.kinds import KINDS
from cliffscan.simulator.sensors import SENSORS

if TYPE_CHECKING:
    Source = str
    Sensor = str
else:
    Source = Literal[*KINDS, ""]
    Sensor = Literal[*SENSORS]

KINECT = (640, 480)  # pixels
KINECT_RANGE = (0.5, 4.5)  # [m]


class CaptureConfig(ServiceConfig):
    """Where depth frames come from, how the camera is mounted, and how frames travel."""

    PROFILES: ClassVar[Profiles] = {"paper": {"floor": "fixed"}}

    source: Source = ""
    """Where depth frames come from. It must be set: a robot must never drive by pictures that nobody chose."""
    compressed: bool = True
    """Whether frames travel compressed, without loss; false sends raw 16UC1."""
    fit_link: bool = True
    """Whether a frame waits until earlier ones are answered with a fused scan, and is smaller where answers stay late:
    the rows that matter, and one of two or three columns, as exact as the sensor's noise lets them be. While nobody
    answers every frame goes, and all of it."""
    frame: Annotated[str, Field(max_length=256)] = "camera_depth_optical_frame"
    """Name of the camera's optical frame."""
    rate: Annotated[float, Field(gt=0, le=1000)] = 30.0
    """Frame rate [Hz] of the simulator and of a replay."""

    floor: Literal["fixed", "tracked"] = "tracked"
    """Where the floor is: fixed where the mount has it, or tracked, which is measured in each frame near the mount."""

    # the nominal mount, where the source has none of its own
    height: Annotated[float, Field(gt=0, le=20)] = 0.30
    """Height [m] of the camera above the floor; a depth folder brings its own."""
    pitch: Annotated[float, Field(gt=-87, lt=87)] = 0.0
    """Angle [deg] by which the camera looks down; a depth folder brings its own."""
    roll: Annotated[float, Field(ge=-180, le=180)] = 0.0
    """Angle [deg] by which the camera leans to its right; a depth folder brings its own."""

    # what the sensor is like
    noise: Annotated[float, Field(ge=0, le=MOST_NOISE)] = 0.0
    """Standard deviation [1/m] of the sensor's inverse depth, steps included; 0 is what the source says of its sensor.
    `cliffscan calibrate` measures it."""
    baseline: Annotated[float, Field(ge=0, le=WIDEST_BASELINE)] = 0.0
    """Distance [m] between the sensor's two eyes, or its eye and its projector; 0 is what the source says."""
    region: Annotated[tuple[int, ...], ListAsTuple] = ()
    """First column, first row, last column and last row [px] that can carry a return at all. While it is empty, what
    the source says counts, or else what `capture` learns from its pictures. `cliffscan calibrate` measures it."""
    range: Annotated[tuple[float, ...], ListAsTuple] = ()
    """Least and largest depth [m] along the optical axis that is trusted. While it is empty, what the source says
    counts."""

    # where the camera stands on the base
    x: Annotated[float, Field(ge=-FARTHEST_PLACE, le=FARTHEST_PLACE)] = TURTLEBOT_2.x
    """Where the camera stands [m], ahead of the middle between the wheels; a TurtleBot 2's Kinect stands behind it."""
    y: Annotated[float, Field(ge=-FARTHEST_PLACE, le=FARTHEST_PLACE)] = TURTLEBOT_2.y
    """Where the camera stands [m], to the left of the middle between the wheels."""
    yaw: Annotated[float, Field(ge=-180, le=180)] = math.degrees(TURTLEBOT_2.yaw)
    """Where the camera looks [deg], counter-clockwise from straight ahead."""

    # ros2
    topic: Annotated[str, Field(pattern=r"^(/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*)?$", max_length=200)] = ""
    """The depth topic of ROS; while it is empty, ros2 takes /camera/depth/image_rect_raw. One that ends with
    compressedDepth is compressed. Its CameraInfo is camera_info beside it."""
    domain: Annotated[int, Field(ge=0, le=232)] = 0
    """ROS_DOMAIN_ID of the camera's driver."""

    # replay
    path: str = ""
    """The depth folder, ROS bag or MCAP file that is replayed."""
    loop: bool = True
    """Whether a replay begins again at its end."""

    # simulator
    world: str = "paper_room"
    """The world that the simulator shows: a file of simulator/worlds, or random:SEED."""
    simulation: str = ""
    """Address of a running `python -m simulator`, a path or HOST:PORT; with none, nothing moves."""
    sensor: Sensor = "kinect"
    """The sensor that is simulated."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of the simulated sensor's noise."""

    # kinect
    device: Annotated[int, Field(ge=0)] = 0
    """Which of several Kinects, counted from 0."""
    depth_mode: Literal["mm", "11bit"] = "mm"
    """What the Kinect sends: millimetres by its factory calibration, or its raw 11-bit disparities."""
    intrinsics: Annotated[tuple[float, float, float, float], ListAsTuple] = (575.8, 575.8, 314.5, 235.5)
    """The Kinect's fx, fy, cx, cy [px]."""

    # realsense and openni2
    serial: Annotated[str, Field(max_length=256)] = ""
    """Serial number of the camera; while it is empty, the first camera. openni2 takes an OpenNI2 address, too."""
    size: Annotated[tuple[int, ...], ListAsTuple] = ()
    """Width and height [px] of the camera's images, one that it offers. While it is empty, the largest counts that has
    no more than 848x480 pixels."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        for name, numbers, expected in (("region", self.region, 4), ("range", self.range, 2), ("size", self.size, 2)):
            if len(numbers) not in (0, expected):
                raise ValueError(f"{name}: {len(numbers)} numbers, expected none or {expected}")
        check_camera(self.kinect())
        return self

    def check(self) -> None:
        """Raise ConfigError where no source is set."""
        if not self.source:
            raise ConfigError(
                f"capture.source is not set: choose one of {', '.join(KINDS)}, as --set capture.source=kinect"
            )

    def mounted_floor(self) -> FloorPlane:
        """The floor as the mount has it."""
        return FloorPlane.from_mount(self.height, math.radians(self.pitch), math.radians(self.roll))

    def place(self) -> Place:
        """Where the camera stands on the base."""
        return Place(self.x, self.y, math.radians(self.yaw))

    def kinect(self) -> Camera:
        """The Kinect as it is mounted."""
        return Camera(*KINECT, Intrinsics(*self.intrinsics), self._reach(KINECT_RANGE), self.mounted_floor())

    def camera(self, own: Camera) -> Camera:
        """A source's own camera, with the range, noise, baseline and region that are configured. Raises ConfigError."""
        camera = replace(
            own,
            range=self._reach(own.range),
            noise=self.noise or own.noise,
            baseline=self.baseline or own.baseline,
            seen=Region(*self.region) if self.region else own.seen,
        )
        try:
            check_camera(camera)
        except ValueError as error:
            raise ConfigError(f"capture.{error}") from error
        return camera

    def _reach(self, own: tuple[float, float]) -> tuple[float, float]:
        return (self.range[0], self.range[1]) if self.range else own
