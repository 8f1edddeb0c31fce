"""The configuration of positive."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from common.scans import ScanConfig


class PositiveConfig(ScanConfig):
    """The beams of the scan and what stands in the robot's way."""

    robot_height: Annotated[float, Field(gt=0)] = 0.42  # [m] a TurtleBot 2; what is higher is passed under

    @model_validator(mode="after")
    def _above_floor(self) -> Self:
        if self.robot_height <= self.floor_band:
            raise ValueError(f"robot_height {self.robot_height} is not above floor_band {self.floor_band}")
        return self
