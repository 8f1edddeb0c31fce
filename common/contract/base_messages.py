"""The messages of the robot's base, each field with its unit and limits."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from cliffscan.common.contract import limits
from cliffscan.common.contract.message import Float32s, ListAsTuple, Message, Stamp

Name = Annotated[str, limits.NAME]
Metres = Annotated[float, limits.COORDINATE]
Radians = Annotated[float, limits.HEADING]
Speed = Annotated[float, limits.SPEED]
Reading = Annotated[float, limits.READING]
Count = Annotated[int, limits.COUNT]
Twist2 = Annotated[tuple[Speed, Speed], ListAsTuple]  # linear [m/s], angular [rad/s]
Triple = Annotated[tuple[Metres, Metres, Radians], ListAsTuple]  # x, y [m], theta [rad]
Matrix3 = Annotated[list[Annotated[float, limits.VARIANCE]], Field(min_length=9, max_length=9)]  # row by row
Flags2 = Annotated[tuple[bool, bool], ListAsTuple]  # left, right
Flags3 = Annotated[tuple[bool, bool, bool], ListAsTuple]  # left, centre, right
Counts3 = Annotated[tuple[Count, Count, Count], ListAsTuple]  # left, centre, right

Rule = Literal[
    "free",
    "no_base",
    "refused",
    "stopped",
    "wheel_drop",
    "overcurrent",
    "cliff",
    "bumper",
    "odometry",
    "no_command",
    "no_scan",
    "obstacle",
    "limit",
]


class Velocity(Message):
    """What somebody wants the robot to do."""

    stamp: Stamp
    linear: Speed  # [m/s] forward
    angular: Speed  # [rad/s] counter-clockwise
    source: Name = ""  # who drives: one source at a time
    priority: Annotated[int, Field(ge=-(2**31), lt=2**31)] = 0  # a higher one takes over at once


class Odometry(Message):
    """Where the robot is by its wheels and its gyro, and how it moves; no jumps, but it drifts."""

    stamp: Stamp
    frame: Name
    child_frame: Name
    pose: Triple
    twist: Twist2
    pose_covariance: Matrix3  # of x, y, theta
    twist_covariance: Matrix3  # of the velocities along x and y and about z


class BaseState(Message):
    """What the base senses; left comes first, then centre, then right."""

    stamp: Stamp
    bumpers: Flags3  # pressed
    cliffs: Flags3  # no floor below the sensor
    cliff_counts: Counts3  # raw, 0 to 4095, not linear in the distance
    wheel_drops: Flags2  # hanging in the air
    overcurrents: Flags2  # above 3 A: the base cuts its motors
    currents: Annotated[tuple[Reading, Reading], ListAsTuple]  # [A] of the motors
    buttons: Flags3  # B0, B1, B2 pressed
    battery_voltage: Reading  # [V]
    battery_percent: Reading  # 0 to 100
    charger: Name  # discharging, dock_charging, dock_charged, adapter_charging, adapter_charged, unknown
    dock_ir: Counts3  # bits 1 near left, 2 near centre, 4 near right, 8 far centre, 16 far left, 32 far right
    digital_inputs: Annotated[tuple[bool, bool, bool, bool], ListAsTuple]
    analog_inputs: Annotated[tuple[Reading, Reading, Reading, Reading], ListAsTuple]  # [V]


class Imu(Message):
    """The base's gyro: its own heading, and every sample since the packet before."""

    stamp: Stamp
    frame: Name
    heading: Radians  # as the base integrates it, arbitrary zero
    heading_rate: Speed  # [rad/s]
    sample_stamps: Annotated[list[Stamp], Field(max_length=limits.MOST_SAMPLES)]  # [ns], oldest first
    angular_velocities: Float32s  # [rad/s] about x, y, z, sample by sample

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if len(self.angular_velocities) != 3 * len(self.sample_stamps):
            raise ValueError(
                f"angular_velocities: {len(self.angular_velocities)} numbers for {len(self.sample_stamps)} samples"
            )
        if not all(map(math.isfinite, self.angular_velocities.tolist())):  # NumPy takes longer over so few
            raise ValueError("angular_velocities: not finite")
        return self


class SafetyState(Message):
    """Which rule holds, and what it did to the command."""

    stamp: Stamp
    rule: Rule
    distance: Metres  # to what holds the robot back; -1 where nothing does
    asked: Twist2
    allowed: Twist2
    latched: bool  # until `clear_safety`
    note: Annotated[str, limits.TEXT]  # for people
