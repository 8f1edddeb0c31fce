"""The settings of a gate, which the service of any base has."""

import math
from typing import Annotated

from pydantic import Field

from cliffscan.common.runtime.config import ServiceConfig
from cliffscan.safety.inputs import SafetyLimits

Seconds = Annotated[float, Field(gt=0, le=5)]


class GateConfig(ServiceConfig):
    """How fast the robot may be, and what keeps it safe; the defaults are a TurtleBot 2's."""

    # how fast it may be
    max_linear: Annotated[float, Field(gt=0, le=0.70)] = 0.70
    """Highest speed [m/s]."""
    max_angular: Annotated[float, Field(gt=0, le=110)] = 110.0
    """Highest turn rate [deg/s]; beyond 110 the gyro degrades."""
    acceleration: Annotated[float, Field(gt=0, le=5)] = 0.5
    """Highest acceleration [m/s²]."""
    angular_acceleration: Annotated[float, Field(gt=0, le=2000)] = 200.0
    """Highest angular acceleration [deg/s²]."""

    # when it must stop
    command_timeout: Seconds = 0.3
    """Time [s] without a command after which the robot stands."""
    stamp_tolerance: Seconds = 0.5
    """Time [s] by which a command's stamp may differ from this clock."""
    require_scan: bool = True
    """Whether the robot only turns, slowly, without a fresh fused scan."""
    scan_timeout: Seconds = 0.3
    """Largest age [s] of a fresh scan, since it was taken and since it came."""
    slow_turn: Annotated[float, Field(ge=0, le=110)] = 30.0
    """Highest turn rate [deg/s] without a scan."""

    # what it can collide with, and how it brakes
    robot_radius: Annotated[float, Field(gt=0, le=1)] = 0.18
    """Radius [m] of the robot's body."""
    robot_height: Annotated[float, Field(gt=0, le=3)] = 0.42
    """Height [m] of the robot's body, as it is described to others."""
    margin: Annotated[float, Field(ge=0, le=1)] = 0.03
    """Distance [m] kept from what is in the way."""
    deceleration: Annotated[float, Field(gt=0, le=5)] = 0.6
    """Deceleration [m/s²] with which the base brakes, at the least."""
    reaction: Seconds = 0.25
    """Time [s] from a decision to its effect: about 0.2 s of the base's own, a packet's age, and 0.02 s to the next
    decision. The age of the scan is measured and added."""

    start_free: Annotated[float, Field(ge=0, le=1.4)] = 0.5
    """Radius [m] of the free floor around the place where the robot was put down."""

    def limits(self) -> SafetyLimits:
        """What the gate must know of this base, in SI units."""
        return SafetyLimits(
            max_linear=self.max_linear,
            max_angular=math.radians(self.max_angular),
            acceleration=self.acceleration,
            angular_acceleration=math.radians(self.angular_acceleration),
            deceleration=self.deceleration,
            reaction=self.reaction,
            radius=self.robot_radius,
            margin=self.margin,
            start_free=self.start_free,
            command_timeout=self.command_timeout,
            stamp_tolerance=self.stamp_tolerance,
            require_scan=self.require_scan,
            scan_timeout=self.scan_timeout,
            slow_turn=math.radians(self.slow_turn),
        )
