"""The configuration of fuse."""

from typing import Annotated

from pydantic import Field, field_validator

from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.contract.topics import SCAN_FUSED, SCAN_SAFE, message_at
from cliffscan.common.runtime.config import ServiceConfig


class ExtraInput(ServiceConfig):
    """A further scan, on its own grid and from its own place. Without a fresh one nothing is published."""

    key: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*$")]
    """The scan's key below the robot's name, as scan/lidar."""
    x: float = 0.0
    """Where the sensor is mounted [m], ahead of the floor's point below the camera."""
    y: float = 0.0
    """Where the sensor is mounted [m], to the left of the floor's point below the camera."""
    yaw: float = 0.0
    """Where the sensor looks [deg], counter-clockwise from the camera's heading."""
    max_age: Annotated[float, Field(gt=0)] = 0.2
    """Time [s] by which the scan's stamp may differ from the frame's."""

    @field_validator("key")
    @classmethod
    def _somebody_elses(cls, key: str) -> str:
        if key in (SCAN_FUSED.path, SCAN_SAFE.path) or message_at(key) not in (None, LaserScan):
            raise ValueError(f"{key} is no scan of somebody else")
        return key


class FuseConfig(ServiceConfig):
    """How long scans wait for their partner, and the extra inputs by name."""

    timeout: Annotated[float, Field(gt=0)] = 0.5
    """Time [s] after which a scan without its partner is dropped."""
    inputs: Annotated[dict[str, ExtraInput], Field(default_factory=dict)]
    """Further scans by a name of their own, one table [fuse.inputs.NAME] each."""

    @field_validator("inputs")
    @classmethod
    def _names(cls, inputs: dict[str, ExtraInput]) -> dict[str, ExtraInput]:
        if inputs.keys() & {"positive", "negative"}:
            raise ValueError("an extra input cannot be named positive or negative")
        return inputs
