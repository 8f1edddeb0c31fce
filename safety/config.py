"""The settings of a gate, which the service of any base has."""

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from cliffscan.common.contract.description import MOST_CORNERS, BodyDescription
from cliffscan.common.contract.message import ListAsTuple
from cliffscan.common.runtime.config import ServiceConfig
from cliffscan.safety.hull import footprint_error, hull_of
from cliffscan.safety.inputs import SafetyLimits
from cliffscan.safety.velocity_limiter import room_to_turn

Seconds = Annotated[float, Field(gt=0, le=5)]
Coordinate = Annotated[float, Field(ge=-2, le=2)]
Corner = Annotated[tuple[Coordinate, Coordinate], ListAsTuple]


class SafetyConfig(ServiceConfig):
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
    footprint: Annotated[tuple[Corner, ...], ListAsTuple, Field(max_length=MOST_CORNERS)] = ()
    """Corners x, y [m] of the robot's body from above, in order, ahead and to the left of the middle between the
    wheels, as [[0.3, 0.25], [0.3, -0.25], [-0.4, -0.25], [-0.4, 0.25]]; while it is empty, the body is the disc."""
    robot_height: Annotated[float, Field(gt=0, le=3)] = 0.42
    """Height [m] of the robot's body, as it is described to others."""
    margin: Annotated[float, Field(ge=0, le=1)] = 0.03
    """Distance [m] kept from what is in the way."""
    deceleration: Annotated[float, Field(gt=0, le=5)] = 0.6
    """Deceleration [m/s²] with which the base brakes, at the least."""
    angular_deceleration: Annotated[float, Field(gt=0, le=2000)] = 150.0
    """Deceleration [deg/s²] with which a turn on the spot ends, at the least; it counts for a `footprint`."""
    reaction: Seconds = 0.25
    """Time [s] from a decision to its effect: about 0.2 s of the base's own, a packet's age, and 0.02 s to the next
    decision. The age of the scan is measured and added."""

    start_free: Annotated[float, Field(ge=0, le=1.4)] = 0.5
    """Radius [m] of the free floor around the place where the robot was put down."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if not self.footprint:
            return self
        if error := footprint_error(self.footprint):
            raise ValueError(f"footprint: {error}")
        room = room_to_turn(hull_of(self.robot_radius, self.footprint), self.margin).outer
        if self.start_free < room:
            raise ValueError(
                f"start_free: {self.start_free:g} m is less than the footprint needs to turn on the spot: set"
                f" {math.ceil(100 * room) / 100:g} or more, and put the robot down where so much floor is free"
            )
        return self

    def body(self, simulated: bool) -> BodyDescription:
        """The body as it is described to others; simulated: whether the base is."""
        return BodyDescription(
            simulated=simulated,
            radius=hull_of(self.robot_radius, self.footprint).outer,
            footprint=self.footprint,
            height=self.robot_height,
        )

    def limits(self) -> SafetyLimits:
        """What the gate must know of this base, in SI units."""
        return SafetyLimits(
            max_linear=self.max_linear,
            max_angular=math.radians(self.max_angular),
            acceleration=self.acceleration,
            angular_acceleration=math.radians(self.angular_acceleration),
            deceleration=self.deceleration,
            angular_deceleration=math.radians(self.angular_deceleration),
            reaction=self.reaction,
            radius=self.robot_radius,
            footprint=self.footprint,
            margin=self.margin,
            start_free=self.start_free,
            command_timeout=self.command_timeout,
            stamp_tolerance=self.stamp_tolerance,
            require_scan=self.require_scan,
            scan_timeout=self.scan_timeout,
            slow_turn=math.radians(self.slow_turn),
        )
