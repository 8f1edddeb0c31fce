"""The configuration of capture."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal, Self, get_args

from pydantic import Field, model_validator

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics, check_camera
from cliffscan.common.contract.description import TURTLEBOT_2, Place
from cliffscan.common.contract.message import ListAsTuple
from cliffscan.common.runtime.config import ConfigError, Profiles, ServiceConfig

Source = Literal["simulator", "replay", "kinect"]
KINECT = (640, 480)  # pixels


class CaptureConfig(ServiceConfig):
    """Where depth frames come from, how the camera is mounted, and how frames travel."""

    PROFILES: ClassVar[Profiles] = {"paper": {"floor": "fixed"}}

    source: Literal[Source, ""] = ""  # must be set: a robot must never drive by pictures nobody chose
    compressed: bool = True  # without loss; False sends raw 16UC1
    frame: Annotated[str, Field(max_length=256)] = "camera_depth_optical_frame"
    rate: Annotated[float, Field(gt=0, le=1000)] = 30.0  # [Hz] of the simulator and of a replay

    # where the floor is in a frame: where the mount has it, or measured in the frame, near the mount
    floor: Literal["fixed", "tracked"] = "tracked"

    # the nominal mount, for the simulator and the Kinect; a depth folder brings its own
    height: Annotated[float, Field(gt=0, le=20)] = 0.30  # [m] of the camera above the floor
    pitch: Annotated[float, Field(gt=-87, lt=87)] = 0.0  # [deg] the camera looks down
    roll: Annotated[float, Field(ge=-180, le=180)] = 0.0  # [deg] the camera leans to its right

    # where the camera stands on the base, seen from the middle between the wheels
    x: Annotated[float, Field(ge=-5, le=5)] = TURTLEBOT_2.x  # [m] ahead: the Kinect of a TurtleBot 2 stands behind
    y: Annotated[float, Field(ge=-5, le=5)] = TURTLEBOT_2.y  # [m] to the left
    yaw: Annotated[float, Field(ge=-180, le=180)] = math.degrees(TURTLEBOT_2.yaw)  # [deg] the camera looks to the left

    # replay
    path: str = ""  # a depth folder
    loop: bool = True  # play it again and again

    # simulator
    world: str = "paper_room"
    simulation: str = ""  # address of a running `python -m simulator`, path or HOST:PORT; empty: nothing moves
    seed: Annotated[int, Field(ge=0)] = 0  # of the sensor's noise

    # kinect
    device: Annotated[int, Field(ge=0)] = 0  # which of several
    depth_mode: Literal["mm", "11bit"] = "mm"  # calibrated in the device, or its raw disparities
    intrinsics: Annotated[tuple[float, float, float, float], ListAsTuple] = (
        575.8,
        575.8,
        314.5,
        235.5,
    )  # fx, fy, cx, cy [px]
    range: Annotated[tuple[float, float], ListAsTuple] = (0.5, 4.5)  # [m] along the optical axis that is trusted

    @model_validator(mode="after")
    def _possible(self) -> Self:
        check_camera(self.kinect())
        return self

    def check(self) -> None:
        """Raise ConfigError where no source is set."""
        if not self.source:
            choices = ", ".join(get_args(Source))
            raise ConfigError(f"capture.source is not set: choose one of {choices}, as --set capture.source=kinect")

    def mounted_floor(self) -> FloorPlane:
        """The floor as the mount has it."""
        return FloorPlane.from_mount(self.height, math.radians(self.pitch), math.radians(self.roll))

    def place(self) -> Place:
        """Where the camera stands on the base."""
        return Place(self.x, self.y, math.radians(self.yaw))

    def kinect(self) -> Camera:
        """The Kinect as it is mounted."""
        return Camera(*KINECT, Intrinsics(*self.intrinsics), self.range, self.mounted_floor())
