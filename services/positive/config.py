"""The configuration of positive."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from cliffscan.common.perception.scans import ScanConfig, steepest_rise
from cliffscan.common.runtime.config import Profiles


class PositiveConfig(ScanConfig):
    """The beams of the scan and what stands in the robot's way."""

    PROFILES: ClassVar[Profiles] = {"paper": {"steepest": 0.0}}

    steepest: Annotated[float, Field(ge=0, le=20)] = 5.0
    """Slope [deg] up to which a ramp is floor, as for negative; 0: the floor is flat."""
    robot_height: Annotated[float, Field(gt=0)] = 0.42
    """Height [m] of the robot, a TurtleBot 2's by default; it passes under what is higher."""

    @model_validator(mode="after")
    def _above_floor(self) -> Self:
        if self.robot_height <= self.floor_band:
            raise ValueError(f"robot_height {self.robot_height} is not above floor_band {self.floor_band}")
        return self

    @property
    def slope(self) -> float:
        """Rise per metre of the steepest floor, as it may look; 0 where the floor is flat."""
        return steepest_rise(self.steepest) if self.steepest else 0.0
