"""The configuration of kobuki."""

from typing import Any

from pydantic import model_validator

from cliffscan.safety.config import SafetyConfig

DESCRIBED = {  # settings that are known from the camera's description
    "camera_x": "set capture.x instead",
    "camera_y": "set capture.y instead",
    "camera_yaw": "set capture.yaw instead",
    "blind": "it follows from capture.height and capture.pitch",
}


class KobukiConfig(SafetyConfig):
    """The port, how fast the robot may be, and what keeps it safe."""

    port: str = "/dev/kobuki"
    """The serial port of the base."""

    @model_validator(mode="before")
    @classmethod
    def _refuse_described(cls, values: dict[str, Any]) -> dict[str, Any]:
        for name, remedy in DESCRIBED.items():
            if name in values:
                raise ValueError(f"{name} is gone, for the camera's description says it: {remedy}")
        return values
