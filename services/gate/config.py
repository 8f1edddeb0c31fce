"""The configuration of gate."""

from typing import Annotated

from pydantic import Field

from cliffscan.safety.config import SafetyConfig


class GateConfig(SafetyConfig):
    """How fast a base of any make may be, how it brakes, and what keeps it safe."""

    simulated: bool = False
    """Whether the base is simulated. A real base is not driven by the pictures of a simulated camera."""
    max_linear: Annotated[float, Field(gt=0, le=2)] = 0.5
    """Highest speed [m/s]."""
    max_angular: Annotated[float, Field(gt=0, le=360)] = 90.0
    """Highest turn rate [deg/s]."""
