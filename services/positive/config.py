"""The configuration of positive."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from cliffscan.common.perception.scans import ImageScanConfig
from cliffscan.common.runtime.config import Profiles


class PositiveConfig(ImageScanConfig):
    """What stands in the robot's way."""

    PROFILES: ClassVar[Profiles] = {"paper": {"flat_floor": True}}

    flat_floor: bool = False
    """Whether the floor is taken to be flat and measured exactly, as in the paper: no ramp is floor, and no noise."""
    robot_height: Annotated[float, Field(gt=0)] = 0.42
    """Height [m] of the robot; it passes under what is higher. Where it is not set, the height that the base describes
    counts, and a TurtleBot 2's until one does."""

    @model_validator(mode="after")
    def _above_floor(self) -> Self:
        if self.robot_height <= self.floor_band:
            raise ValueError(f"robot_height {self.robot_height} is not above floor_band {self.floor_band}")
        return self

    def on_body(self, height: float | None) -> Self:
        """These settings on a body of that height [m], where they give none and it is above the floor band."""
        if height is None or height <= self.floor_band or "robot_height" in self.model_fields_set:
            return self
        return self.model_copy(update={"robot_height": height})

    @property
    def slope(self) -> float:
        """Rise per metre of the steepest floor, as it may look; 0 where the floor is flat."""
        return 0.0 if self.flat_floor else self.steepest_rise()

    @property
    def lowest_rise(self) -> float:
        """Height [m] above which a step up is in the way although floor_band is higher; 0 = none, as in the paper."""
        return 0.0 if self.flat_floor else self.wheel_step
